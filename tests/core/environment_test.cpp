// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <iostream>
#include <limits>
#include <random>
#include <utility>

#include "core/environment/environment_model.h"
#include "core/environment/filtered_map.h"
#include "core/error.h"
#include "core/gl/program.h"
#include "core/material/model.h"
#include "core/passes/environment_filter.h"
#include "core/scene/environment_map.h"
#include "tests/core/model_device.h"

namespace verglas {
namespace {

using glm::dvec3;
using glm::vec3;
using glm::vec4;

const vec4& texel(const EnvironmentLattice& lattice, int x, int y) {
    return lattice.texels[std::size_t(y) * (lattice.level.columns + 1) + x];
}

vec3 direction(const EnvironmentLevel& level, int x, int y) {
    return model::environment_direction({float(x) / float(level.columns), float(y) / float(level.intervals)});
}

// The levels of one device.
struct Filtered {
    const char* device;
    std::vector<EnvironmentLattice> levels;
    double seconds;
};

template <typename Work>
double seconds_of(Work work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Filtered filter_by_opengl(const std::shared_ptr<const EnvironmentMap>& map) {
    return gl_thread().run([&] {
        const EnvironmentFilter filter;
        FilteredEnvironment filtered;
        Filtered result{"OpenGL", {}, 0.0};
        result.seconds = seconds_of([&] {
            filtered = filter.filter(map);
            glFinish();
        });
        for (const EnvironmentLevel& level : filtered.levels) {
            EnvironmentLattice lattice{level, {}};
            lattice.texels.resize(std::size_t(level.columns + 1) * (level.intervals + 1));
            glGetTextureSubImage(filtered.atlas.id(), 0, 0, level.first_row, 0, level.columns + 1,
                                 level.intervals + 1, 1, GL_RGBA, GL_FLOAT,
                                 static_cast<GLsizei>(lattice.texels.size() * sizeof(vec4)),
                                 lattice.texels.data());
            result.levels.push_back(std::move(lattice));
        }
        return result;
    });
}

Filtered filter_by_cpu(const std::shared_ptr<const EnvironmentMap>& map) {
    Filtered result{"CPU", {}, 0.0};
    result.seconds = seconds_of([&] { result.levels = filter_environment(map)->levels; });
    return result;
}

std::array<Filtered, 2> filter(const std::shared_ptr<const EnvironmentMap>& map) {
    return {filter_by_opengl(map), filter_by_cpu(map)};
}

double solid_angle(const EnvironmentMap& map, int y) {
    const double begin = glm::pi<double>() * y / map.height();
    const double end = glm::pi<double>() * (y + 1) / map.height();
    return 2.0 * glm::pi<double>() / map.width() * (std::cos(begin) - std::cos(end));
}

// The map convolved with a normalised spherical Gaussian, in double precision. Texels are areas of constant
// radiance; where the kernel is about as narrow, each is integrated at points of equal area.
dvec3 brute_force(const EnvironmentMap& map, double kappa, const vec3& direction) {
    const double texel = 2.0 * glm::pi<double>() / map.width();
    const int points = kappa * texel * texel > 0.02 ? 5 : 1;
    const double reach = std::acos(std::max(1.0 - 25.0 / kappa, -1.0)) + texel;
    const dvec3 d(direction);
    const double angle_d = std::acos(glm::clamp(-d.z, -1.0, 1.0));
    const double azimuth_d = std::atan2(d.y, d.x);
    dvec3 sum(0.0);
    for (int y = 0; y < map.height(); ++y) {
        const double angle = glm::pi<double>() * (y + 0.5) / map.height();
        if (std::abs(angle - angle_d) > reach) continue;
        const double lower = std::cos(glm::pi<double>() * y / map.height());
        const double upper = std::cos(glm::pi<double>() * (y + 1) / map.height());
        const double sines = std::sin(angle) * std::sin(angle_d);
        for (int x = 0; x < map.width(); ++x) {
            const double center = (0.5 - (x + 0.5) / map.width()) * 2.0 * glm::pi<double>();
            const double gamma_cosine = -std::cos(angle) * d.z + sines * std::cos(center - azimuth_d);
            if (gamma_cosine < std::cos(std::min(reach, glm::pi<double>()))) continue;
            double kernel = 0.0;
            for (int j = 0; j < points; ++j) {
                const double z = -glm::mix(lower, upper, (j + 0.5) / points);
                const double sine = std::sqrt(1.0 - z * z);
                for (int i = 0; i < points; ++i) {
                    const double azimuth =
                        (0.5 - (x + (i + 0.5) / points) / map.width()) * 2.0 * glm::pi<double>();
                    const dvec3 w(sine * std::cos(azimuth), sine * std::sin(azimuth), z);
                    kernel += std::exp(-0.5 * kappa * glm::dot(w - d, w - d));
                }
            }
            sum += dvec3(map.pixels()[std::size_t(y) * map.width() + x]) *
                   (solid_angle(map, y) * kernel / double(points * points));
        }
    }
    return kappa / (2.0 * glm::pi<double>() * (1.0 - std::exp(-2.0 * kappa))) * sum;
}

double greatest(const dvec3& v) { return std::max({v.x, v.y, v.z}); }

double luminance(const dvec3& rgb) { return (rgb.r + rgb.g + rgb.b) / 3.0; }

struct Difference {
    double mean_relative;
    double of_maximum;
};

// A random texel of a level: anywhere, uniformly over the sphere, or within three widths of the level's
// Gaussian about a focus.
glm::ivec2 draw_texel(const EnvironmentLevel& level, const vec3* focus, std::mt19937& random) {
    std::normal_distribution<float> normal;
    const vec3 noise(normal(random), normal(random), normal(random));
    const vec3 direction = glm::normalize(
        focus != nullptr ? *focus + noise * 1.5F / std::sqrt(std::max(level.kappa, 1.0F)) : noise);
    const glm::vec2 uv = model::environment_uv(direction);
    return {std::lround(uv.x * float(level.columns)), std::lround(uv.y * float(level.intervals))};
}

// Compares a level of all devices with the truth at random texels.
template <std::size_t devices>
std::array<Difference, devices> compare(const std::array<Filtered, devices>& filtered, std::size_t level,
                                        const EnvironmentMap& map, int count, const vec3* focus,
                                        std::mt19937& random) {
    const EnvironmentLevel& plan = filtered[0].levels[level].level;
    std::vector<glm::ivec2> places;
    for (int i = 0; i < count; ++i) places.push_back(draw_texel(plan, focus, random));
    std::vector<double> truths(count);
    tbb::parallel_for(0, count, [&](int i) {
        truths[i] = luminance(brute_force(map, plan.kappa, direction(plan, places[i].x, places[i].y)));
    });
    std::array<Difference, devices> result{};
    for (std::size_t d = 0; d < devices; ++d) {
        const EnvironmentLattice& lattice = filtered[d].levels[level];
        double maximum = 0.0;
        for (const vec4& value : lattice.texels) maximum = std::max(maximum, luminance(dvec3(value)));
        for (int i = 0; i < count; ++i) {
            const double difference =
                std::abs(luminance(dvec3(texel(lattice, places[i].x, places[i].y))) - truths[i]);
            result[d].mean_relative += difference / std::max(truths[i], 1e-6) / count;
            result[d].of_maximum = std::max(result[d].of_maximum, difference / maximum);
        }
    }
    return result;
}

// Trapezoid rule over rows; the integrand f(a) sin(a) has a corner at the poles, where the first term of
// Euler and Maclaurin's formula, step^2 / 12 f, joins it.
double integral(const EnvironmentLattice& lattice) {
    double sum = 0.0;
    const double step = glm::pi<double>() / lattice.level.intervals;
    for (int y = 0; y <= lattice.level.intervals; ++y) {
        const bool pole = y == 0 || y == lattice.level.intervals;
        const double weight = pole ? step * step / 12.0 : step * std::sin(step * y);
        for (int x = 0; x < lattice.level.columns; ++x)
            sum += luminance(dvec3(texel(lattice, x, y))) * weight * 2.0 * glm::pi<double>() /
                   lattice.level.columns;
    }
    return sum;
}

double integral(const EnvironmentMap& map) {
    double sum = 0.0;
    for (int y = 0; y < map.height(); ++y) {
        for (int x = 0; x < map.width(); ++x)
            sum += luminance(dvec3(map.pixels()[std::size_t(y) * map.width() + x])) * solid_angle(map, y);
    }
    return sum;
}

void print_seconds(const std::array<Filtered, 2>& filtered) {
    for (const Filtered& device : filtered) std::cout << device.device << " " << device.seconds << " s  ";
    std::cout << "\n";
}

void expect_integrals_kept(const std::array<Filtered, 2>& filtered, const EnvironmentMap& map) {
    const double truth = integral(map);
    for (const Filtered& device : filtered) {
        for (const EnvironmentLattice& lattice : device.levels)
            EXPECT_NEAR(integral(lattice) / truth, 1.0, 0.005)
                << map.name() << ", " << device.device << ", kappa " << lattice.level.kappa;
    }
}

// Every texel at random in 0 … 1, but for one of the given radiance.
std::shared_ptr<const EnvironmentMap> random_map(int width, int height, float sun, std::mt19937& random) {
    std::uniform_real_distribution<float> unit;
    std::vector<vec3> pixels(std::size_t(width) * height);
    for (vec3& pixel : pixels) pixel = vec3(unit(random), unit(random), unit(random));
    pixels[pixels.size() / 3] += sun;
    return std::make_shared<const EnvironmentMap>(std::to_string(width) + " x " + std::to_string(height),
                                                  width, height, std::move(pixels));
}

std::vector<std::filesystem::path> studio_maps() {
    std::vector<std::filesystem::path> maps;
    const std::filesystem::path folder = "/usr/share/blender/datafiles/studiolights/world";
    if (!std::filesystem::is_directory(folder)) return maps;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".exr") maps.push_back(entry.path());
    }
    std::sort(maps.begin(), maps.end());
    return maps;
}

// A user loses: reflections and refractions as bright and as blurred as the map and the roughness say.
TEST(Environment, LevelsOfBlendersMapsAreTheConvolution) {
    const auto maps = studio_maps();
    if (maps.empty()) GTEST_SKIP() << "Blender's studio maps are not installed where Debian puts them";
    std::mt19937 random(7);
    for (const auto& path : maps) {
        const auto map = EnvironmentMap::load(path.string(), false);
        const auto filtered = filter(map);
        std::cout << path.filename() << " " << map->width() << " x " << map->height() << ": ";
        print_seconds(filtered);
        for (std::size_t l = 0; l < filtered[0].levels.size(); ++l) {
            const auto errors = compare(filtered, l, *map, 10, nullptr, random);
            for (std::size_t d = 0; d < errors.size(); ++d) {
                const Filtered& device = filtered[d];
                const float kappa = device.levels[l].level.kappa;
                std::cout << "  " << device.device << ", kappa " << kappa << ": mean relative error "
                          << errors[d].mean_relative << "\n";
                EXPECT_LE(errors[d].mean_relative, 0.02) << path << ", " << device.device << ", " << kappa;
            }
        }
        expect_integrals_kept(filtered, *map);
    }
}

// A user loses: a sun that is as bright through rough glass as through clear glass, without flicker or loss.
TEST(Environment, SunOfOnePixelKeepsItsLight) {
    std::mt19937 random(11);
    for (const glm::ivec2 at :
         {glm::ivec2(300, 330), glm::ivec2(1023, 256), glm::ivec2(700, 509), glm::ivec2(10, 0)}) {
        std::vector<vec3> pixels(1024 * 512, vec3(0.0F));
        pixels[at.y * 1024 + at.x] = vec3(100000.0F);
        const auto map = std::make_shared<const EnvironmentMap>("sun", 1024, 512, pixels);
        const auto filtered = filter(map);
        std::cout << "sun at " << at.x << ", " << at.y << ": ";
        print_seconds(filtered);
        const vec3 sun =
            model::environment_direction({(float(at.x) + 0.5F) / 1024.0F, (float(at.y) + 0.5F) / 512.0F});
        for (std::size_t l = 0; l < filtered[0].levels.size(); ++l) {
            const auto errors = compare(filtered, l, *map, 10, &sun, random);
            for (std::size_t d = 0; d < errors.size(); ++d) {
                const Filtered& device = filtered[d];
                const float kappa = device.levels[l].level.kappa;
                std::cout << "  " << device.device << ", kappa " << kappa << ": worst, of the maximum "
                          << errors[d].of_maximum << "\n";
                EXPECT_LE(errors[d].of_maximum, 0.02)
                    << "sun at " << at.x << ", " << at.y << ", " << device.device << ", " << kappa;
            }
        }
        expect_integrals_kept(filtered, *map);
    }
}

// A user loses: a sun behind rough glass: the widest kernels cover the sphere, with more than half of their
// peak at the point opposite to it, which rounding left out, on GPUs everywhere and on CPUs here and there.
TEST(Environment, WideKernelsReachTheOppositePoint) {
    constexpr int width = 64;
    constexpr int height = 32;
    constexpr int intervals = 8;  // of the widest level
    for (int row = 1; row < intervals; ++row) {
        std::vector<vec3> pixels(width * height, vec3(0.0F));
        const int above = height - row * height / intervals;  // the point is a corner of four pixels
        for (const int y : {above - 1, above}) {
            for (const int x : {width / 2 - 1, width / 2}) pixels[y * width + x] = vec3(1000.0F);
        }
        const auto map = std::make_shared<const EnvironmentMap>("sun", width, height, pixels);
        for (const Filtered& device : filter(map)) {
            const EnvironmentLattice& widest = device.levels.back();
            ASSERT_EQ(widest.level.intervals, intervals);
            const double truth =
                luminance(brute_force(*map, widest.level.kappa, direction(widest.level, 0, row)));
            EXPECT_NEAR(luminance(dvec3(texel(widest, 0, row))) / truth, 1.0, 0.02)
                << device.device << ", " << row;
        }
    }
}

// A user loses: a smooth sky above: at a pole all columns of a level are one direction.
TEST(Environment, PolesAreOnePoint) {
    std::mt19937 random(4);
    for (const Filtered& device : filter(random_map(512, 256, 0.0F, random))) {
        for (const EnvironmentLattice& lattice : device.levels) {
            for (const int y : {0, lattice.level.intervals}) {
                for (int x = 0; x < lattice.level.columns; ++x)
                    EXPECT_NEAR(greatest(dvec3(texel(lattice, x, y) / texel(lattice, 0, y))), 1.0, 1e-5)
                        << device.device << ", kappa " << lattice.level.kappa << ": " << x << ", " << y;
            }
        }
    }
}

// A user loses: the same picture on a machine with a GPU and on one without.
TEST(Environment, DevicesFilterAlike) {
    std::mt19937 random(5);
    for (const auto& map : {random_map(500, 300, 0.0F, random), random_map(64, 32, 1e5F, random)}) {
        const auto filtered = filter(map);
        ASSERT_EQ(filtered[0].levels.size(), filtered[1].levels.size());
        for (std::size_t l = 0; l < filtered[0].levels.size(); ++l) {
            const EnvironmentLattice& a = filtered[0].levels[l];
            const EnvironmentLattice& b = filtered[1].levels[l];
            ASSERT_EQ(a.texels.size(), b.texels.size());
            double worst = 0.0;
            double maximum = 0.0;
            for (std::size_t i = 0; i < a.texels.size(); ++i) {
                worst = std::max(worst, greatest(glm::abs(dvec3(a.texels[i]) - dvec3(b.texels[i]))));
                maximum = std::max(maximum, greatest(dvec3(a.texels[i])));
            }
            // A texel at the very end of a kernel, e^-7 of its peak and a fifteenth of its sum, may count for
            // one device and not for the other.
            EXPECT_LE(worst / maximum, 7e-5) << map->name() << ", kappa " << a.level.kappa;
        }
    }
}

struct Query {
    vec3 direction;
    float spread;
};

// What incoming_radiance of shaders/environment.glsl answers.
std::vector<vec4> look_up_by_opengl(const std::shared_ptr<const EnvironmentMap>& map,
                                    const std::vector<Query>& queries) {
    const std::string text =
        gl::full_source("environment.glsl") +
        "vec4 look_up(vec4 query) { return vec4(incoming_radiance(query.xyz, query.w), 1.0); }\n";
    FilteredEnvironment environment;
    const auto bind = [&](GLuint program) {
        environment = EnvironmentFilter().filter(map);
        const auto place = [&](const std::string& name) {
            return glGetUniformLocation(program, name.c_str());
        };
        glBindTextureUnit(0, environment.raw.id());
        glBindTextureUnit(1, environment.atlas.id());
        glProgramUniform1i(program, place("environment_map"), 0);
        glProgramUniform1i(program, place("environment_atlas"), 1);
        for (std::size_t l = 0; l < environment.levels.size(); ++l) {
            const EnvironmentLevel& level = environment.levels[l];
            glProgramUniform4f(program, place("environment_levels[" + std::to_string(l) + "]"),
                               float(level.columns), float(level.intervals), float(level.first_row),
                               model::spread_from_kappa(level.kappa));
        }
        glProgramUniform1i(program, place("environment_level_count"), int(environment.levels.size()));
        glProgramUniform3f(program, place("environment_color"), 1.0F, 1.0F, 1.0F);
        glProgramUniformMatrix3fv(program, place("view_to_environment"), 1, GL_FALSE,
                                  glm::value_ptr(glm::mat3(1.0F)));
    };
    auto answers = compute<vec4>({text, "vec4", "vec4", "look_up"}, bind, queries);
    gl_thread().run([&] { environment = {}; });
    return answers;
}

std::vector<vec4> look_up_by_cpu(const std::shared_ptr<const EnvironmentMap>& map,
                                 const std::vector<Query>& queries) {
    const model::EnvironmentModel model(filter_environment(map));
    std::vector<vec4> answers;
    for (const auto& [direction, spread] : queries)
        answers.emplace_back(model.environment_radiance(direction, spread), 1.0F);
    return answers;
}

// Everywhere, at the poles and on both sides of the seam, under lobes of every width.
std::vector<Query> draw_queries(int count, std::mt19937& random) {
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> log_spread(-14.0F, 0.0F);
    std::vector<Query> queries;
    for (const vec3 direction : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(-1, 1e-7F, 0), vec3(-1, -1e-7F, 0)}) {
        for (const float spread : {0.0F, 1e-3F, 1.0F}) queries.push_back({direction, spread});
    }
    while (static_cast<int>(queries.size()) < count)
        queries.push_back({glm::normalize(vec3(normal(random), normal(random), normal(random))),
                           std::exp(log_spread(random))});
    return queries;
}

// A user loses: the same picture on a machine with a GPU and on one without.
TEST(Environment, DevicesLookUpAlike) {
    std::mt19937 random(6);
    const auto map = random_map(300, 100, 0.0F, random);
    const std::vector<Query> queries = draw_queries(5000, random);
    const std::vector<vec4> by_opengl = look_up_by_opengl(map, queries);
    const std::vector<vec4> by_cpu = look_up_by_cpu(map, queries);
    for (std::size_t i = 0; i < queries.size(); ++i) {
        const auto& [direction, spread] = queries[i];
        const dvec3 difference(by_cpu[i] - by_opengl[i]);
        // GPUs interpolate in 256 steps, between texels that differ by 1 at most.
        EXPECT_LE(greatest(glm::abs(difference)), 1.0 / 256.0)
            << direction.x << ", " << direction.y << ", " << direction.z << ", spread " << spread;
    }
}

class EnvironmentLookup : public OnDevice {};
ON_BOTH_DEVICES(EnvironmentLookup);

// A user loses: roughness that goes from clear to matt without a step or a lobe of a wrong width on the way.
TEST_P(EnvironmentLookup, IsTheConvolutionBetweenLevels) {
    const auto maps = studio_maps();
    if (maps.empty()) GTEST_SKIP() << "Blender's studio maps are not installed where Debian puts them";
    const auto map = EnvironmentMap::load(maps.front().string(), false);
    std::mt19937 random(8);
    std::normal_distribution<float> normal;
    constexpr int directions = 10;  // for each spread
    std::vector<Query> queries;
    for (const float spread : {2e-4F, 3e-3F, 0.04F, 0.3F, 0.8F}) {
        for (int i = 0; i < directions; ++i)
            queries.push_back({glm::normalize(vec3(normal(random), normal(random), normal(random))), spread});
    }
    const auto answers =
        GetParam() == Device::Cpu ? look_up_by_cpu(map, queries) : look_up_by_opengl(map, queries);
    for (std::size_t first = 0; first < queries.size(); first += directions) {
        const float spread = queries[first].spread;
        double error = 0.0;
        for (std::size_t i = first; i < first + directions; ++i) {
            const double truth =
                luminance(brute_force(*map, model::kappa_from_spread(spread), queries[i].direction));
            error += std::abs(luminance(dvec3(answers[i])) / truth - 1.0) / directions;
        }
        std::cout << "spread " << spread << ": mean relative error " << error << "\n";
        EXPECT_LE(error, 0.02) << spread;
    }
}

// A user loses: a render that goes on, and a word about what was wrong, when a map has broken texels.
TEST(Environment, CleansWhatIsNoLight) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const EnvironmentMap map("broken", 2, 2,
                             {vec3(nan, 1, 2), vec3(-3, 4, 5), vec3(infinity, 6, 7), vec3(8)});
    ASSERT_EQ(map.warnings().size(), 1U);
    EXPECT_NE(map.warnings()[0].find("broken"), std::string::npos);
    EXPECT_EQ(map.pixels()[0], vec3(0, 1, 2));
    EXPECT_EQ(map.pixels()[1], vec3(0, 4, 5));
    EXPECT_EQ(map.pixels()[2], vec3(8, 6, 7));
}

// A user loses: small, odd and very wide maps, which must light the scene as any other.
TEST(Environment, AnySizeKeepsItsLight) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(0.0F, 2.0F);
    for (const glm::ivec2 size :
         {glm::ivec2(1, 1), glm::ivec2(3, 2), glm::ivec2(100, 51), glm::ivec2(5000, 20)}) {
        std::vector<vec3> pixels(std::size_t(size.x) * size.y);
        for (vec3& pixel : pixels) pixel = vec3(unit(random));
        const auto map = std::make_shared<const EnvironmentMap>("odd", size.x, size.y, pixels);
        expect_integrals_kept(filter(map), *map);
    }
}

// A user loses: skies beyond half float's 65504, which must neither overflow nor vanish.
TEST(Environment, SunBeyondHalfFloat) {
    std::vector<vec3> pixels(64 * 32, vec3(0.5F));
    pixels[20 * 64 + 13] = vec3(1e7F);
    const auto map = std::make_shared<const EnvironmentMap>("bright sun", 64, 32, pixels);
    expect_integrals_kept(filter(map), *map);
}

// A user loses: a map that is painted over, and seen as it is now, whatever its size was before.
TEST(Environment, ReadsAFileThatWasReplaced) {
    const auto path = std::filesystem::temp_directory_path() / "verglas_replaced.ppm";
    for (const int size : {2, 64}) {
        std::ofstream file(path, std::ios::binary);
        file << "P6 " << size << " " << size << " 255 " << std::string(3 * size * size, '\xff');
        file.close();
        const auto map = EnvironmentMap::load(path.string(), false);
        EXPECT_EQ(map->width(), size);
        EXPECT_EQ(map->pixels().back(), vec3(1.0F));
    }
    std::filesystem::remove(path);
}

// A user loses: a clear sentence with the file's name where a map is missing or broken.
TEST(Environment, NamesTheFileThatCannotBeRead) {
    const auto broken = std::filesystem::temp_directory_path() / "verglas_broken.hdr";
    std::ofstream(broken) << "this is no picture";
    for (const std::string& path : {std::string("/nowhere/sky.exr"), broken.string()}) {
        try {
            EnvironmentMap::load(path, false);
            FAIL() << path;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
        }
    }
    std::filesystem::remove(broken);
}

}  // namespace
}  // namespace verglas
