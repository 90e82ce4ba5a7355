// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/path_tracer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>
#include <random>

#include "core/error.h"
#include "core/material/microfacet.h"
#include "core/tracing/environment_light.h"
#include "tests/core/reference_lobes.h"
#include "tests/core/shapes.h"

namespace verglas {
namespace {

using glm::vec2;
using glm::vec3;

constexpr Ndf ndfs[] = {Ndf::Beckmann, Ndf::Ggx, Ndf::BlinnPhong};

vec3 direction(double cosine) { return {float(std::sqrt(1.0 - cosine * cosine)), 0.0F, float(cosine)}; }

// A researcher loses: a ground truth whose samples have the energy and mean of the integrated microfacet
// model.
TEST(RoughInterface, SamplesMeetIntegrationOverDirections) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (const Ndf ndf : ndfs) {
        for (const double eta : {1.5, 1.0 / 1.5}) {
            for (const double cosine : {0.95, 0.6, 0.25}) {
                const float alpha = 0.3F;
                const RoughInterface surface(ndf, alpha, float(eta), true, Reflected::All);
                const vec3 o = direction(cosine);
                double refracted = 0.0;
                double reflected = 0.0;
                glm::dvec3 vector(0.0);  // of what is refracted
                constexpr int count = 60000;
                for (int i = 0; i < count; ++i) {
                    const auto sample = surface.sample(o, vec2(unit(random), unit(random)), unit(random));
                    if (!sample) continue;
                    const double weight = sample->weight / double{count};
                    const bool down = sample->direction.z < 0.0F;
                    (down ? refracted : reflected) += weight;
                    if (down) vector += weight * glm::dvec3(sample->direction);
                }
                const auto through = reference::integrate(ndf, alpha, eta, LobeEvent::Refract, cosine);
                const auto back = reference::integrate(ndf, alpha, eta, LobeEvent::Reflect, cosine);
                EXPECT_NEAR(refracted, through.energy, 0.015) << int(ndf) << " " << eta << " " << cosine;
                if (through.energy < 0.01) continue;
                const double spread = 1.0 - glm::length(vector) / refracted;
                EXPECT_NEAR(spread / through.spread(), 1.0, 0.05) << int(ndf) << " " << eta << " " << cosine;
                EXPECT_GT(glm::dot(glm::normalize(vector), through.direction()), 0.9999);
                EXPECT_NEAR(reflected, back.energy, 0.015) << int(ndf) << " " << eta << " " << cosine;
            }
        }
    }
}

// A researcher loses: multiple importance sampling without bias; a sample's weight is what evaluation says of
// it.
TEST(RoughInterface, WeightIsValueOverDensity) {
    std::mt19937 random(8);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    for (const Ndf ndf : ndfs) {
        for (const float eta : {1.5F, 1.0F / 1.5F}) {
            const RoughInterface surface(ndf, 0.4F, eta, true, Reflected::All);
            const vec3 o = direction(0.5);
            for (int i = 0; i < 300; ++i) {
                const auto sample = surface.sample(o, vec2(unit(random), unit(random)), unit(random));
                if (!sample) continue;
                const auto value = surface.evaluate(o, sample->direction);
                EXPECT_NEAR(value.f_cos / (value.pdf * sample->weight), 1.0F, 0.02F)
                    << int(ndf) << " " << eta;
            }
        }
    }
}

// A researcher loses: noise-free skies; directions are drawn with the density that is claimed for them,
// around whatever lobe.
TEST(EnvironmentLight, DensityIsNormalisedAndFollowsTheLight) {
    std::vector<vec3> pixels(64 * 32, vec3(0.1F));
    pixels[20 * 64 + 40] = vec3(500.0F);
    Scene scene;
    scene.environment_map = std::make_shared<const EnvironmentMap>("sun", 64, 32, pixels);
    scene.environment_color = vec3(1.0F);
    const EnvironmentLight light(scene);
    double truth = 0.0;
    for (int y = 0; y < 32 * 8; ++y) {
        const double theta = glm::pi<double>() * (y + 0.5) / 256.0;
        for (int x = 0; x < 64 * 8; ++x) {
            const double azimuth = 2.0 * glm::pi<double>() * (x + 0.5) / 512.0;
            const vec3 d(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
                         std::cos(theta));
            truth += light.radiance(d).g * std::sin(theta) * (glm::pi<double>() / 256.0) *
                     (2.0 * glm::pi<double>() / 512.0);
        }
    }
    std::mt19937 random(2);
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    const vec3 axis = glm::normalize(vec3(0.5F, -0.3F, 0.6F));
    for (const float kappa : {0.0F, 0.5F}) {
        const EnvironmentLight::Lobe lobe = light.lobe(axis, kappa);
        double mean_inverse = 0.0;
        double radiance = 0.0;
        double claimed = 0.0;  // the density of a drawn direction, over that with which it was drawn
        constexpr int count = 200000;
        for (int i = 0; i < count; ++i) {
            const auto sample = light.sample(lobe, vec2(unit(random), unit(random)));
            claimed += light.at(lobe, sample.direction).pdf / sample.pdf / count;
            mean_inverse += 1.0 / sample.pdf / count;
            radiance += light.radiance(sample.direction).g / sample.pdf / count;
        }
        EXPECT_NEAR(mean_inverse / (4.0 * glm::pi<double>()), 1.0, 0.03) << kappa;
        EXPECT_NEAR(radiance / truth, 1.0, 0.02) << kappa;
        EXPECT_NEAR(claimed, 1.0, 0.001) << kappa;
    }
    const EnvironmentLight::Lobe narrow = light.lobe(axis, 1e6F);
    double near = 0.0;
    for (int i = 0; i < 1000; ++i) {
        const auto sample = light.sample(narrow, vec2(unit(random), unit(random)));
        near += glm::dot(sample.direction, axis) > 0.8F ? 1e-3 : 0.0;
    }
    EXPECT_GT(near, 0.9);
}

Scene glass_sphere(float roughness, Ndf ndf) {
    Scene scene;
    Material material;
    material.ndf = ndf;
    material.roughness = roughness;
    scene.materials = {material};
    scene.objects = {{"Sphere", shapes::sphere(), glm::mat4(1.0F), {0}}};
    scene.camera.view = glm::lookAt(vec3(0, -4, 0), vec3(0), vec3(0, 0, 1));
    scene.camera.projection = glm::perspective(0.6F, 1.0F, 0.1F, 100.0F);
    scene.environment_color = vec3(1.0F);
    return scene;
}

PathSettings settings_of(PathMode mode) {
    PathSettings settings;
    settings.size = glm::ivec2(32);
    settings.mode = mode;
    return settings;
}

Frame render(const Scene& scene, const PathSettings& settings, int samples) {
    PathTracer tracer(scene, settings);
    EXPECT_TRUE(tracer.render(samples));
    return tracer.frame();
}

// One interface that nothing lies behind, turned by an angle against an orthographic camera.
Scene tilted_pane(float roughness, Ndf ndf, double cosine) {
    Scene scene = glass_sphere(roughness, ndf);
    const std::vector<vec3> corners = {{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
    scene.objects[0].mesh = std::make_shared<const Mesh>("Pane", corners, std::vector<vec3>(4, vec3(0, 0, 1)),
                                                         std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}},
                                                         std::vector<std::uint16_t>());
    scene.camera.view = glm::lookAt(20.0F * direction(cosine), vec3(0), vec3(0, 1, 0));
    scene.camera.projection = glm::ortho(-0.1F, 0.1F, -0.1F, 0.1F, 0.1F, 100.0F);
    return scene;
}

double mean_inside(const Frame& frame) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < frame.combined.size(); ++i) {
        if (frame.normal_depth[i].w > 1e9F) continue;
        sum += frame.combined[i].g;
        count += 1.0;
    }
    return sum / count;
}

// A researcher loses: energy that is neither made nor lost (white furnace), but for what single scattering
// loses by the model itself, here by integration over directions.
TEST(PathTracer, OneInterfaceKeepsTheEnergyOfTheModel) {
    for (const Ndf ndf : ndfs) {
        for (const float roughness : {0.1F, 0.4F, 0.7F, 1.0F}) {
            for (const double cosine : {0.9, 0.4}) {
                if (ndf == Ndf::BlinnPhong && roughness == 1.0F) continue;  // its exponent would be 0
                const double found =
                    mean_inside(render(tilted_pane(roughness, ndf, cosine), settings_of(PathMode::Full), 16));
                const double alpha = roughness * roughness;
                const double predicted =
                    reference::integrate(ndf, alpha, 1.5, LobeEvent::Refract, cosine).energy +
                    reference::integrate(ndf, alpha, 1.5, LobeEvent::Reflect, cosine).energy;
                EXPECT_NEAR(found, predicted, 0.004) << int(ndf) << " " << roughness << " " << cosine;
            }
        }
    }
}

// A researcher loses: energy that is not made inside either, and hardly lost where single scattering loses
// little.
TEST(PathTracer, WhiteFurnace) {
    for (const Ndf ndf : ndfs) {
        double last = 1.005;
        for (const float roughness : {0.05F, 0.4F, 0.8F}) {
            const double mean =
                mean_inside(render(glass_sphere(roughness, ndf), settings_of(PathMode::Full), 64));
            std::cout << "furnace, distribution " << int(ndf) << ", roughness " << roughness << ": " << mean
                      << "\n";
            EXPECT_LE(mean, last);
            EXPECT_GE(mean, roughness < 0.1F ? 0.995 : 0.4);
            last = mean;
        }
    }
}

// A researcher loses: a truth of two interfaces without bias. A sphere that reflects nothing is left by its
// second interface for good, so that paths of all interfaces, with one direction each, have the same mean as
// the many directions that are drawn at a second interface.
TEST(PathTracer, TwoInterfacesAreAllOfASphereWithoutReflection) {
    std::vector<vec3> pixels(64 * 32, vec3(0.1F));
    for (int y = 14; y < 20; ++y) std::fill_n(&pixels[y * 64 + 14], 6, vec3(10.0F));
    for (const Ndf ndf : ndfs) {
        for (const float roughness : {0.3F, 0.7F}) {
            Scene scene = glass_sphere(roughness, ndf);
            scene.materials[0].fresnel = false;
            scene.environment_map = std::make_shared<const EnvironmentMap>("sun", 64, 32, pixels);
            const double all = mean_inside(render(scene, settings_of(PathMode::Full), 64));
            const double two = mean_inside(render(scene, settings_of(PathMode::TwoInterface), 32));
            EXPECT_NEAR(two / all, 1.0, 0.003) << int(ndf) << " " << roughness;
        }
    }
}

// A researcher loses: pictures that can be had again, on any number of cores.
TEST(PathTracer, DependsOnTheSeedAloneNotOnThreads) {
    const Scene scene = glass_sphere(0.4F, Ndf::Ggx);
    PathSettings settings = settings_of(PathMode::Full);
    const Frame parallel = render(scene, settings, 4);
    {
        const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        EXPECT_EQ(render(scene, settings, 4).combined, parallel.combined);
    }
    settings.seed = 1;
    EXPECT_NE(render(scene, settings, 4).combined, parallel.combined);
}

// A user loses: Esc during a long render, and what was rendered until then.
TEST(PathTracer, EndsWhenAskedAndGoesOn) {
    PathSettings settings = settings_of(PathMode::Full);
    settings.size = glm::ivec2(512, 130);  // three blocks of rows a sample
    const Scene scene = glass_sphere(0.4F, Ndf::Ggx);
    PathTracer tracer(scene, settings);
    EXPECT_THROW(tracer.frame(), Error);
    int calls = 0;
    EXPECT_FALSE(tracer.render(1000, [&calls](int, int) { return ++calls < 4; }));
    EXPECT_EQ(tracer.samples(), 1);
    EXPECT_TRUE(tracer.render(2));
    EXPECT_EQ(tracer.samples(), 3);
    EXPECT_EQ(tracer.frame().combined, render(scene, settings, 3).combined);
}

}  // namespace
}  // namespace verglas
