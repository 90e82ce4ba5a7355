// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/traced_renderer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/material/model.h"
#include "core/renderer.h"
#include "core/tracing/path_tracer.h"
#include "tests/core/reference_sphere.h"
#include "tests/core/shapes.h"

namespace verglas {
namespace {

using glm::dvec3;
using glm::ivec2;
using glm::mat4;
using glm::vec3;
using glm::vec4;

template <typename Radiance>
std::shared_ptr<const EnvironmentMap> map_of(Radiance radiance) {
    constexpr int width = 256;
    constexpr int height = 128;
    std::vector<vec3> pixels;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x)
            pixels.push_back(radiance(
                model::environment_direction({(float(x) + 0.5F) / width, (float(y) + 0.5F) / height})));
    }
    return std::make_shared<const EnvironmentMap>("Map", width, height, pixels);
}

// Smooth, without a sun, and different in every direction.
std::shared_ptr<const EnvironmentMap> smooth_map() {
    static const auto map = map_of([](const vec3& d) {
        return vec3(0.3F + 0.7F * std::exp(4.0F * (d.x - 1.0F)), 0.6F + 0.4F * std::sin(3.0F * d.z),
                    1.0F + 0.8F * d.x * d.y);
    });
    return map;
}

// One of Blender's studio maps, with a sun; null where it isn't found.
std::shared_ptr<const EnvironmentMap> forest_map() {
    const std::string path = "/usr/share/blender/datafiles/studiolights/world/forest.exr";
    return std::filesystem::exists(path) ? EnvironmentMap::load(path, false) : nullptr;
}

// Clear glass spheres before a camera at a distance of 4, in a white world.
Scene scene_of(const std::vector<mat4>& places, float roughness) {
    Scene scene;
    Material material;
    material.roughness = roughness;
    scene.materials = {material};
    for (const mat4& place : places) scene.objects.push_back({"Sphere", shapes::sphere(), place, {0}});
    scene.camera.view = glm::lookAt(vec3(0, -4, 0), vec3(0), vec3(0, 0, 1));
    scene.camera.projection = glm::perspective(0.6F, 1.0F, 0.1F, 100.0F);
    scene.environment_color = vec3(1.0F);
    return scene;
}

Scene glass_sphere(float roughness) { return scene_of({mat4(1.0F)}, roughness); }

mat4 sphere_at(const vec3& position, float radius) {
    return glm::scale(glm::translate(mat4(1.0F), position), vec3(radius));
}

// Edges against the world and each other, and across the frame's left and upper border and corner.
Scene many_edges() {
    Scene scene =
        scene_of({sphere_at(vec3(0.3F, 0.0F, -0.3F), 0.6F), sphere_at(vec3(-0.2F, 0.5F, 0.2F), 0.6F),
                  sphere_at(vec3(-1.2F, 0.0F, 1.2F), 0.5F), sphere_at(vec3(-1.2F, 0.0F, -0.5F), 0.3F)},
                 0.3F);
    scene.environment_map = smooth_map();
    return scene;
}

Settings settings_of(int size, int samples) {
    Settings settings;
    settings.size = ivec2(size);
    settings.samples = samples;
    return settings;
}

// By one renderer for all, which keeps what it has prepared.
Frame render(const Scene& scene, const Settings& settings) {
    static TracedRenderer renderer;
    const auto frame = renderer.render(scene, settings);
    EXPECT_TRUE(frame);
    return *frame;
}

bool is_inside(const Frame& frame, std::size_t i) { return frame.normal_depth[i].w < 1e9F; }

double mean_inside(const Frame& frame) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < frame.combined.size(); ++i) {
        if (!is_inside(frame, i)) continue;
        sum += (frame.combined[i].r + frame.combined[i].g + frame.combined[i].b) / 3.0;
        count += 1.0;
    }
    return sum / count;
}

// A user loses: the same picture again, on this machine and the next, whatever their number of cores.
TEST(TracedRenderer, DependsOnNoThreads) {
    const tbb::global_control three(tbb::global_control::max_allowed_parallelism, 3);  // on any machine
    const Scene scene = many_edges();
    for (const int samples : {1, 5}) {
        Settings settings = settings_of(64, samples);
        settings.threads = 1;
        const Frame one = render(scene, settings);
        for (const int threads : {2, 3}) {
            settings.threads = threads;
            const Frame frame = render(scene, settings);
            EXPECT_EQ(frame.combined, one.combined) << samples << " samples, " << threads << " threads";
            EXPECT_EQ(frame.normal_depth, one.normal_depth) << samples << " samples, " << threads;
        }
    }
}

// A user loses: render regions and tiles without seams: what a pixel shows must not depend on how far the
// picture goes around it.
TEST(TracedRenderer, RegionIsAPartOfTheWhole) {
    const Scene scene = many_edges();
    TracedRenderer renderer;
    for (const float filter_width : {1.5F, 3.2F}) {
        for (const int samples : {1, 5}) {
            Settings settings = settings_of(64, samples);
            settings.filter_width = filter_width;
            settings.background_alpha = 0.0F;
            const Frame whole = *renderer.render(scene, settings);
            for (const Rect& region : {Rect{{20, 17}, {45, 40}}, Rect{{0, 40}, {21, 64}},
                                       Rect{{40, 0}, {64, 3}}, Rect{{31, 31}, {32, 32}}}) {
                settings.region = region;
                const Frame part = *renderer.render(scene, settings);
                ASSERT_EQ(part.size, region.size());
                int different = 0;
                for (int y = region.begin.y; y < region.end.y; ++y) {
                    for (int x = region.begin.x; x < region.end.x; ++x) {
                        const std::size_t i =
                            std::size_t(y - region.begin.y) * part.size.x + x - region.begin.x;
                        const std::size_t j = std::size_t(y) * 64 + x;
                        different += part.combined[i] != whole.combined[j] ||
                                             part.normal_depth[i] != whole.normal_depth[j]
                                         ? 1
                                         : 0;
                    }
                }
                EXPECT_EQ(different, 0)
                    << "of " << part.combined.size() << " pixels, " << samples << " samples, filter "
                    << filter_width << ", from " << region.begin.x << ", " << region.begin.y;
            }
        }
    }
}

// A user loses: thumbnails and very small regions, which have no neighbours to average with.
TEST(TracedRenderer, SmallestPictures) {
    for (const ivec2 size : {ivec2(1), ivec2(1, 7), ivec2(17, 1)}) {
        for (const int samples : {1, 3}) {
            Settings settings = settings_of(1, samples);
            settings.size = size;
            const Frame frame = render(many_edges(), settings);
            ASSERT_EQ(frame.combined.size(), std::size_t(size.x) * size.y);
            for (const vec4& pixel : frame.combined)
                EXPECT_TRUE(glm::all(glm::greaterThan(pixel, vec4(0.0F))) &&
                            glm::all(glm::lessThan(pixel, vec4(2.0F))))
                    << pixel.r << " " << pixel.g << " " << pixel.b;
        }
    }
}

double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

// A user loses: a viewport that follows the mouse, and Esc: whatever a render is at, it asks soon whether to
// go on. Counted in time of the processor on one thread, so that other programs have no part in it. Sky below
// and hollow glass above: what comes next may take many times as long as what came before.
TEST(TracedRenderer, AsksOftenWhetherToGoOn) {
    Scene scene = scene_of({}, 0.4F);
    const mat4 place = sphere_at(vec3(0.0F, 0.0F, 0.5F), 0.6F);
    scene.objects = {{"Bubble", shapes::spheres({1.0F, -0.9F}), place, {0}}};
    scene.environment_map = smooth_map();
    TracedRenderer renderer;
    renderer.render(scene, settings_of(8, 1));  // prepares the scene
    Settings settings = settings_of(1, 2);
    settings.size = ivec2(320, 180);
    settings.threads = 1;
    double last = thread_seconds();
    double longest = 0.0;
    int calls = 0;
    renderer.render(scene, settings, [&](int, int) {
        const double now = thread_seconds();
        longest = std::max(longest, now - last);
        last = now;
        ++calls;
        return true;
    });
    const double end = thread_seconds() - last;
    std::cout << "longest time between " << calls << " calls: " << longest << " s, then " << end << " s\n";
    EXPECT_LT(longest, 0.05);
    EXPECT_LT(end, 0.05);
}

// A user loses: a picture after one that was given up, wherever that was.
TEST(TracedRenderer, EndsWhenAskedInEveryPhase) {
    const Scene scene = many_edges();
    const Settings settings = settings_of(48, 3);
    const Frame whole = render(scene, settings);
    TracedRenderer renderer;
    std::optional<Frame> frame;
    int asked = 0;
    for (int end = 1; !frame; ++end) {
        asked = 0;
        frame = renderer.render(scene, settings, [&](int done, int all) {
            EXPECT_EQ(all, 3);
            EXPECT_LE(done, 3);
            return ++asked < end;
        });
        if (!frame) {
            EXPECT_EQ(asked, end);
        }
    }
    EXPECT_GE(asked, 6);  // first, averaged, prepared, two drawn, resolved
    EXPECT_EQ(frame->combined, whole.combined);
}

// A user loses: a sentence in place of a picture that can't be.
TEST(TracedRenderer, NamesWhatIsWrong) {
    const Scene scene = glass_sphere(0.3F);
    TracedRenderer renderer;
    const auto refuses = [&](auto change) {
        Settings settings = settings_of(8, 1);
        change(settings);
        EXPECT_THROW(renderer.render(scene, settings), Error);
    };
    refuses([](Settings& settings) { settings.size.y = 0; });
    refuses([](Settings& settings) { settings.samples = 0; });
    refuses([](Settings& settings) { settings.max_interfaces = 0; });
    refuses([](Settings& settings) { settings.threads = -1; });
    refuses([](Settings& settings) { settings.region = Rect{{8, 0}, {12, 4}}; });
}

// The lobe that one pixel sees: energy from a white world, the mean vector from one whose radiance is linear
// in the direction, which no blur changes but by the mean length of its lobe.
reference::Moments seen_lobe(double exponent, double b, int samples) {
    Scene scene = glass_sphere(static_cast<float>(std::pow(2.0 / (exponent + 2.0), 0.25)));
    scene.materials[0].ndf = Ndf::BlinnPhong;
    scene.camera.view = glm::lookAt(vec3(0, float(b), 4), vec3(0, float(b), 0), vec3(0, 1, 0));
    scene.camera.projection = glm::ortho(-0.005F, 0.005F, -0.005F, 0.005F, 0.1F, 100.0F);
    Settings settings = settings_of(8, samples);
    settings.paths = PathMode::TwoInterface;
    const auto center = [&] {
        const Frame frame = render(scene, settings);
        vec4 sum(0.0F);
        for (const std::size_t i : {27, 28, 35, 36}) sum += 0.25F * frame.combined[i];
        return dvec3(sum);
    };
    const double energy = center().g;
    static const auto map = map_of([](const vec3& d) { return 1.0F + d; });
    scene.environment_map = map;
    return {energy, center() - energy};
}

// A user loses: glass spheres whose blur and brightness are those of a path tracer, from the centre to the
// rim, in the first picture and in the last.
TEST(TracedRenderer, SphereMeetsMonteCarlo) {
    for (const int samples : {1, 64}) {
        for (const double exponent : {6.4, 24.0}) {
            for (const double b : {0.0, 0.6, 0.92}) {
                const reference::Moments truth = reference::sphere_moments(exponent, b, 100000);
                const reference::Moments lobe = seen_lobe(exponent, b, samples);
                const double degrees =
                    glm::degrees(std::acos(std::min(glm::dot(lobe.direction(), truth.direction()), 1.0)));
                std::cout << samples << " samples, n_D " << exponent << ", b " << b << ": W " << lobe.energy
                          << " (truth " << truth.energy << "), 1 / spread " << 1.0 / lobe.spread() << " ("
                          << 1.0 / truth.spread() << "), " << degrees << " degrees\n";
                EXPECT_NEAR(lobe.energy, truth.energy, 0.01) << samples << " " << exponent << " " << b;
                EXPECT_NEAR(lobe.spread() / truth.spread(), 1.0, 0.05)
                    << samples << " " << exponent << " " << b;
                EXPECT_LE(degrees, 0.5) << samples << " " << exponent << " " << b;
            }
        }
    }
}

Frame path_traced(const Scene& scene, const Settings& settings, int samples, std::uint64_t seed) {
    PathSettings path_settings;
    path_settings.size = settings.size;
    path_settings.mode = settings.paths;
    path_settings.seed = seed;
    PathTracer tracer(scene, path_settings);
    EXPECT_TRUE(tracer.render(samples));
    return tracer.frame();
}

// A user loses: glass that neither glows nor swallows light: in a white world it is as good as invisible,
// less what single scattering at microfacets loses.
TEST(TracedRenderer, WhiteFurnace) {
    struct Allowed {
        int samples;
        double difference;
    };
    for (const float roughness : {0.1F, 0.3F, 0.5F}) {
        const Scene scene = glass_sphere(roughness);
        const double truth = mean_inside(path_traced(scene, settings_of(32, 1), 64, 0));
        for (const auto& [samples, difference] : {Allowed{1, 0.03}, Allowed{4, 0.02}, Allowed{32, 0.01}}) {
            const double mean = mean_inside(render(scene, settings_of(32, samples)));
            std::cout << "furnace, roughness " << roughness << ", " << samples << " samples: " << mean
                      << " (truth " << truth << ")\n";
            EXPECT_NEAR(mean, truth, difference) << roughness << " " << samples;
            EXPECT_LE(mean, 1.005) << roughness << " " << samples;
        }
    }
}

// Mean of (a - truth)^2 / (truth^2 + 0.01) inside of objects. Of two truths with noise of their own, whose
// product has none in the mean.
double relative_error(const Frame& frame, const Frame& truth, const Frame& other_truth) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < frame.combined.size(); ++i) {
        if (!is_inside(frame, i)) continue;
        for (int c = 0; c < 3; ++c) {
            const double a = frame.combined[i][c] - truth.combined[i][c];
            const double b = frame.combined[i][c] - other_truth.combined[i][c];
            const double mean = 0.5 * (truth.combined[i][c] + other_truth.combined[i][c]);
            sum += a * b / (mean * mean + 0.01);
            count += 1.0;
        }
    }
    return sum / count;
}

// A user loses: what further samples are for: each brings the picture nearer to what path tracing finds.
TEST(TracedRenderer, ConvergesToThePathTracer) {
    Scene scene =
        scene_of({sphere_at(vec3(-0.2F, 0.0F, 0.1F), 0.8F), sphere_at(vec3(0.4F, 1.6F, -0.3F), 0.7F)}, 0.4F);
    scene.environment_map = smooth_map();
    const Settings settings = settings_of(64, 1);
    const Frame truth = path_traced(scene, settings, 128, 1);
    const Frame other_truth = path_traced(scene, settings, 128, 2);
    const double truth_mean = 0.5 * (mean_inside(truth) + mean_inside(other_truth));
    std::cout << "truths differ by " << relative_error(truth, other_truth, other_truth) << "\n";
    double last = 1.0;
    for (const int samples : {1, 4, 16, 64}) {
        const Frame frame = render(scene, settings_of(64, samples));
        const double error = relative_error(frame, truth, other_truth);
        const double mean = mean_inside(frame);
        std::cout << samples << " samples: relative MSE " << error << ", mean " << mean << " (truth "
                  << truth_mean << ")\n";
        EXPECT_LT(error, last) << samples;
        EXPECT_NEAR(mean / truth_mean, 1.0, samples < 16 ? 0.03 : 0.01) << samples;
        last = error;
    }
}

// A finely divided sphere with refraction alone, by both devices.
struct Pair {
    Frame by_opengl;
    Frame by_cpu;
};

Settings refraction_only(int size) {
    Settings settings = settings_of(size, 1);
    settings.paths = PathMode::TwoInterface;
    settings.reflection = false;
    settings.tir = Tir::None;
    return settings;
}

// opengl_samples: smooth outlines, which the first traced sample has already.
Pair by_both_devices(const Scene& scene, const Settings& settings, int opengl_samples = 1) {
    static Renderer renderer;
    Settings of_opengl = settings;
    of_opengl.samples = opengl_samples;
    return {*renderer.render(scene, of_opengl), render(scene, settings)};
}

Pair by_both_devices(float roughness, std::shared_ptr<const EnvironmentMap> map, int opengl_samples = 1) {
    Scene scene = glass_sphere(roughness);
    scene.objects[0].mesh = shapes::spheres({1.0F}, 192);
    scene.environment_map = std::move(map);
    return by_both_devices(scene, refraction_only(256), opengl_samples);
}

// A user loses: a window with one frosted side. Its clear side widens no ray of the bundle, and the sun
// behind would be a ring of suns.
TEST(TracedRenderer, FrostedFrontOfClearGlass) {
    constexpr float frosted = 0.35F;
    Scene scene = glass_sphere(frosted);
    scene.materials.push_back(scene.materials[0]);
    scene.materials[1].roughness = 0.0F;
    scene.objects[0].mesh = shapes::slab(-0.05F, 0.05F);
    scene.objects[0].matrix = glm::rotate(mat4(1.0F), glm::half_pi<float>(), vec3(1, 0, 0));
    scene.objects[0].materials = {1, 1, 1, 1, 1, 0};
    scene.environment_map =
        map_of([](const vec3& d) { return vec3(0.05F + 20.0F * std::exp(1000.0F * (d.y - 1.0F))); });
    const Settings settings = settings_of(48, 1);
    const Frame truth = path_traced(scene, settings, 256, 1);
    const Frame other_truth = path_traced(scene, settings, 256, 2);
    const double truth_mean = 0.5 * (mean_inside(truth) + mean_inside(other_truth));
    for (const int samples : {1, 4, 16}) {
        const Frame frame = render(scene, settings_of(48, samples));
        const double error = relative_error(frame, truth, other_truth);
        std::cout << samples << " samples: relative MSE " << error << ", mean "
                  << mean_inside(frame) / truth_mean << " of the truth\n";
        EXPECT_LT(error, 0.002) << samples;
        EXPECT_NEAR(mean_inside(frame) / truth_mean, 1.0, 0.015) << samples;
    }
}

// A user loses: glass before a dark wall. Where the first sample shows no light, all the light of others
// would be an error without measure, and pixels around would flare up. In the white world nothing is brighter
// than 1, but for noise.
TEST(TracedRenderer, DarknessBesideLightStaysInBounds) {
    for (const float roughness : {0.3F, 0.4F}) {
        Scene scene = glass_sphere(roughness);
        scene.materials[0].fresnel = false;
        scene.objects[0].mesh = shapes::slab(-0.5F, 0.5F);
        scene.objects[0].matrix =
            glm::rotate(mat4(1.0F), 0.5F, vec3(1, 0, 0)) * glm::rotate(mat4(1.0F), 0.6F, vec3(0, 0, 1));
        Settings settings = settings_of(128, 8);
        settings.reflection = false;
        for (const vec4& pixel : render(scene, settings).combined) ASSERT_LE(pixel.r, 1.3F) << roughness;
    }
}

// A user loses: F12 that shows what the viewport showed, where one draws on the graphics card and the other
// on the CPU.
TEST(TracedRenderer, AgreesWithOpenGlOnASphere) {
    const auto forest = forest_map();
    if (!forest) GTEST_SKIP() << "Blender's studio maps are not where Debian puts them";
    for (const float roughness : {0.25F, 0.55F}) {
        const auto [by_opengl, by_cpu] = by_both_devices(roughness, forest, 16);
        const double error = relative_error(by_cpu, by_opengl, by_opengl);
        std::cout << "roughness " << roughness << ": devices differ by " << error << "\n";
        EXPECT_LT(error, 0.001) << roughness;
    }
}

// A user loses: the same. Beside the rim, whose back faces a screen hardly sees, nothing but rounding may
// differ.
TEST(TracedRenderer, AgreesWithOpenGlButForTheRim) {
    for (const float roughness : {0.25F, 0.55F}) {
        auto [by_opengl, by_cpu] = by_both_devices(roughness, smooth_map());
        const float radius = 0.85F * 128.0F * std::tan(std::asin(0.25F)) / std::tan(0.3F);  // of the outline
        for (int y = 0; y < 256; ++y) {
            for (int x = 0; x < 256; ++x) {
                if (glm::length(glm::vec2(x, y) - 127.5F) > radius)
                    by_cpu.normal_depth[y * 256 + x].w = 1e10F;
            }
        }
        const double error = relative_error(by_cpu, by_opengl, by_opengl);
        std::cout << "roughness " << roughness << ": devices differ by " << error << "\n";
        EXPECT_LT(error, 1e-4) << roughness;
    }
}

// A user loses: the glow around what is bright behind glass of GGX, Blender's default. With one Gaussian a
// lobe the errors are 0.016 and 0.008.
TEST(TracedRenderer, GgxHasTailsOnBothDevices) {
    const auto forest = forest_map();
    if (!forest) GTEST_SKIP() << "Blender's studio maps are not where Debian puts them";
    for (const float roughness : {0.25F, 0.55F}) {
        Scene scene = glass_sphere(roughness);
        scene.materials[0].ndf = Ndf::Ggx;
        scene.environment_map = forest;
        const Settings settings = refraction_only(64);
        const Frame truth = path_traced(scene, settings, 32, 1);
        const Frame other_truth = path_traced(scene, settings, 32, 2);
        const auto [by_opengl, by_cpu] = by_both_devices(scene, settings);
        const double opengl_error = relative_error(by_opengl, truth, other_truth);
        const double cpu_error = relative_error(by_cpu, truth, other_truth);
        const double most = roughness < 0.5F ? 0.010 : 0.0065;
        EXPECT_LT(opengl_error, most) << roughness;
        EXPECT_LT(cpu_error, most) << roughness;
    }
}

// The Blackman-Harris window over a disc, by summing over it.
double filtered_disc(double x, double y, double radius, double width) {
    constexpr int steps = 60;
    const auto window = [](double t) {
        const double a = 2.0 * glm::pi<double>() * t;
        return 0.35875 - 0.48829 * std::cos(a) + 0.14128 * std::cos(2.0 * a) - 0.01168 * std::cos(3.0 * a);
    };
    double covered = 0.0;
    double all = 0.0;
    for (int j = 0; j < steps; ++j) {
        for (int i = 0; i < steps; ++i) {
            const double s = (i + 0.5) / steps;
            const double t = (j + 0.5) / steps;
            const double weight = window(s) * window(t);
            all += weight;
            if (std::hypot(x + (2.0 * s - 1.0) * width, y + (2.0 * t - 1.0) * width) < radius)
                covered += weight;
        }
    }
    return covered / all;
}

// A user loses: smooth outlines, and film that is transparent beside the glass, from the first sample on,
// without a dark or bright fringe: of a sphere that bends no light, in a white world, light and alpha are the
// same.
TEST(TracedRenderer, EdgesAreSmoothAndTransparent) {
    Scene scene = glass_sphere(0.2F);
    scene.materials[0].ior = 1.0F;
    const float half_width = 1.6F;
    scene.camera.projection = glm::ortho(-half_width, half_width, -half_width, half_width, 0.1F, 100.0F);
    constexpr int size = 48;
    const double radius = 0.5 * size / half_width;
    for (const int samples : {1, 2, 5, 33}) {
        Settings settings = settings_of(size, samples);
        settings.background_alpha = 0.0F;
        const Frame frame = render(scene, settings);
        double area = 0.0;
        double squared = 0.0;
        double edges = 0.0;
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const vec4& pixel = frame.combined[y * size + x];
                area += pixel.a;
                EXPECT_NEAR(pixel.g, pixel.a, 1e-4) << x << " " << y << " " << samples;
                const double truth =
                    filtered_disc(x + 0.5 - 0.5 * size, y + 0.5 - 0.5 * size, radius, settings.filter_width);
                if (truth == 0.0 || truth == 1.0) {
                    EXPECT_NEAR(pixel.a, truth, 1e-4) << x << " " << y << " " << samples;
                } else {
                    squared += (pixel.a - truth) * (pixel.a - truth);
                    edges += 1.0;
                }
            }
        }
        const double truth_area = glm::pi<double>() * radius * radius;
        std::cout << samples << " samples: area / truth " << area / truth_area << ", alpha at edges off by "
                  << std::sqrt(squared / edges) << "\n";
        EXPECT_NEAR(area / truth_area, 1.0, 0.02) << samples;
        EXPECT_LT(std::sqrt(squared / edges), 0.05) << samples;
    }
}

}  // namespace
}  // namespace verglas
