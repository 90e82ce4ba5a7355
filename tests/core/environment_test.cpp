// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <iostream>
#include <limits>
#include <random>
#include <utility>

#include "core/error.h"
#include "core/gl/thread.h"
#include "core/material/model.h"
#include "core/passes/environment_filter.h"
#include "core/scene/environment_map.h"

namespace verglas {
namespace {

using glm::dvec3;
using glm::vec3;

gl::Thread& gl_thread() {
    static gl::Thread thread;
    return thread;
}

struct Lattice {
    EnvironmentLevel level;
    std::vector<glm::vec4> texels;  // (columns + 1) x (intervals + 1)

    const glm::vec4& at(int x, int y) const { return texels[std::size_t(y) * (level.columns + 1) + x]; }
    vec3 direction(int x, int y) const {
        return model::environment_direction(
            {float(x) / float(level.columns), float(y) / float(level.intervals)});
    }
};

struct Filtered {
    std::vector<Lattice> levels;
    double seconds;
};

Filtered filter(const std::shared_ptr<const EnvironmentMap>& map) {
    return gl_thread().run([&] {
        const EnvironmentFilter filter;
        glFinish();
        const auto begin = std::chrono::steady_clock::now();
        const FilteredEnvironment filtered = filter.filter(map);
        glFinish();
        Filtered result;
        result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        for (const EnvironmentLevel& level : filtered.levels) {
            Lattice lattice{level, {}};
            lattice.texels.resize(std::size_t(level.columns + 1) * (level.intervals + 1));
            glGetTextureSubImage(filtered.atlas.id(), 0, 0, level.first_row, 0, level.columns + 1,
                                 level.intervals + 1, 1, GL_RGBA, GL_FLOAT,
                                 static_cast<GLsizei>(lattice.texels.size() * sizeof(glm::vec4)),
                                 lattice.texels.data());
            result.levels.push_back(std::move(lattice));
        }
        return result;
    });
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

// Compares a level with the truth at random texels.
Difference compare(const Lattice& lattice, const EnvironmentMap& map, int count, const vec3* focus,
                   std::mt19937& random) {
    double maximum = 0.0;
    for (const glm::vec4& texel : lattice.texels) maximum = std::max(maximum, luminance(dvec3(texel)));
    std::vector<glm::ivec2> places;
    for (int i = 0; i < count; ++i) places.push_back(draw_texel(lattice.level, focus, random));
    std::vector<Difference> each(count);
    tbb::parallel_for(0, count, [&](int i) {
        const auto [x, y] = std::pair(places[i].x, places[i].y);
        const double truth = luminance(brute_force(map, lattice.level.kappa, lattice.direction(x, y)));
        const double difference = std::abs(luminance(dvec3(lattice.at(x, y))) - truth);
        each[i] = {difference / std::max(truth, 1e-6), difference / maximum};
    });
    Difference result{0.0, 0.0};
    for (const Difference& d : each) {
        result.mean_relative += d.mean_relative / count;
        result.of_maximum = std::max(result.of_maximum, d.of_maximum);
    }
    return result;
}

// Trapezoid rule over rows; the integrand f(a) sin(a) has a corner at the poles, where the first term of
// Euler and Maclaurin's formula, step^2 / 12 f, joins it.
double integral(const Lattice& lattice) {
    double sum = 0.0;
    const double step = glm::pi<double>() / lattice.level.intervals;
    for (int y = 0; y <= lattice.level.intervals; ++y) {
        const bool pole = y == 0 || y == lattice.level.intervals;
        const double weight = pole ? step * step / 12.0 : step * std::sin(step * y);
        for (int x = 0; x < lattice.level.columns; ++x)
            sum +=
                luminance(dvec3(lattice.at(x, y))) * weight * 2.0 * glm::pi<double>() / lattice.level.columns;
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

void expect_integrals_kept(const Filtered& filtered, const EnvironmentMap& map) {
    const double truth = integral(map);
    for (const Lattice& lattice : filtered.levels)
        EXPECT_NEAR(integral(lattice) / truth, 1.0, 0.005) << map.name() << ", kappa " << lattice.level.kappa;
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
        const Filtered filtered = filter(map);
        std::cout << path.filename() << " " << map->width() << " x " << map->height() << ": "
                  << filtered.seconds << " s\n";
        for (const Lattice& lattice : filtered.levels) {
            const Difference error = compare(lattice, *map, 10, nullptr, random);
            std::cout << "  kappa " << lattice.level.kappa << ": mean relative error " << error.mean_relative
                      << "\n";
            EXPECT_LE(error.mean_relative, 0.02) << path << ", kappa " << lattice.level.kappa;
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
        const Filtered filtered = filter(map);
        std::cout << "sun at " << at.x << ", " << at.y << ": " << filtered.seconds << " s\n";
        const vec3 sun =
            model::environment_direction({(float(at.x) + 0.5F) / 1024.0F, (float(at.y) + 0.5F) / 512.0F});
        for (const Lattice& lattice : filtered.levels) {
            const Difference error = compare(lattice, *map, 10, &sun, random);
            std::cout << "  kappa " << lattice.level.kappa << ": worst, of the maximum " << error.of_maximum
                      << "\n";
            EXPECT_LE(error.of_maximum, 0.02)
                << "sun at " << at.x << ", " << at.y << ", kappa " << lattice.level.kappa;
        }
        expect_integrals_kept(filtered, *map);
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
