// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/divergence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

#include "core/tracing/ray_scene.h"
#include "tests/core/shapes.h"

namespace verglas {
namespace {

using glm::dvec2;
using glm::mat4;
using glm::vec3;

constexpr double radius = 2.0;
constexpr double eta = 1.0 / 1.5;  // of leaving the glass
constexpr double angle = 1e-4;     // of the rays about the axis

// A ray in a plane that holds the centre of a ball of glass, which is the origin.
struct PlaneRay {
    dvec2 origin;
    dvec2 d;
};

// It starts at (-radius, 0), close to the axis of x.
PlaneRay ray_across() { return {{-radius, 0.0}, {std::cos(angle), std::sin(angle)}}; }

// Where it meets the ball's wall from inside.
dvec2 wall(const PlaneRay& ray) {
    const double b = glm::dot(ray.origin, ray.d);
    return ray.origin + (-b + std::sqrt(b * b - glm::dot(ray.origin, ray.origin) + radius * radius)) * ray.d;
}

PlaneRay reflected(const PlaneRay& ray) {
    const dvec2 p = wall(ray);
    return {p, glm::reflect(ray.d, -p / radius)};
}

PlaneRay refracted(const PlaneRay& ray) {
    const dvec2 p = wall(ray);
    return {p, glm::refract(ray.d, -p / radius, 1.0 / eta)};
}

// Variance of directions like that, of which one is given, about the axis.
double variance(const PlaneRay& ray) { return std::pow(std::asin(ray.d.y), 2); }

Divergence beam_across() {
    Divergence beam = Divergence::of_lobe(static_cast<float>(angle * angle));
    beam.travel(static_cast<float>(2.0 * radius));
    return beam;
}

constexpr Curvature ball{.mean = static_cast<float>(1.0 / radius), .deviation = 0.0F};

// A user loses: smooth light from inner reflections; their lobes would be of the wrong width.
TEST(Divergence, FollowsRaysThroughABall) {
    const double at_wall = variance(ray_across());
    Divergence mirrored = beam_across();
    mirrored.turn(1.0F, -2.0F, ball);
    EXPECT_NEAR(mirrored.spread() / variance(reflected(ray_across())), 1.0, 1e-3);
    EXPECT_NEAR(mirrored.spread() / at_wall, 9.0, 0.01);  // the wall mirrors its focus, a quarter across

    Divergence bent = beam_across();
    bent.turn(1.0F / static_cast<float>(eta), 1.0F - 1.0F / static_cast<float>(eta), ball);
    EXPECT_NEAR(bent.spread() / variance(refracted(ray_across())), 1.0, 1e-3);

    // Back across after the reflection, and out.
    mirrored.travel(static_cast<float>(2.0 * radius));
    mirrored.turn(1.0F / static_cast<float>(eta), 1.0F - 1.0F / static_cast<float>(eta), ball);
    EXPECT_NEAR(mirrored.spread() / variance(refracted(reflected(ray_across()))), 1.0, 2e-3);
}

// A user loses: the picture, to pixels that are no numbers, where needle-sharp edges turn light everywhere.
TEST(Divergence, StaysFiniteAtAnyCurvature) {
    Divergence beam = Divergence::of_lobe(1.0F);
    for (int i = 0; i < 64; ++i) {
        beam.travel(1e6F);
        beam.turn(1.5F, -2.0F, {.mean = 1e9F, .deviation = 1e9F});
        ASSERT_GE(beam.spread(), 0.0F);
        ASSERT_LE(beam.spread(), 1.0F);
    }
}

// Curvature where a ray from outside meets an ellipsoid of revolution about z at its equator.
std::optional<Curvature> curvature_of(float across, float along) {
    Scene scene;
    scene.materials.resize(1);
    scene.objects = {{"Ball", shapes::sphere(), glm::scale(mat4(1.0F), vec3(across, across, along)), {0}}};
    const RayScene rays(scene);
    const auto hit = rays.intersect({50.0F, 0.1F * across, 0.01F * along}, {-1.0F, 0.0F, 0.0F});
    if (!hit) return std::nullopt;
    return rays.curvature(*hit);
}

// A user loses: the same as above, as the surface's curvature comes from its triangles.
TEST(Divergence, KnowsTheCurvatureOfMeshes) {
    const auto sphere = curvature_of(2.0F, 2.0F);
    ASSERT_TRUE(sphere);
    EXPECT_NEAR(sphere->mean, 0.5, 0.005);
    EXPECT_NEAR(sphere->deviation, 0.0, 0.01);
    // Nearly a cylinder: 1 / 2 around, 2 / 200^2 along.
    const auto cylinder = curvature_of(2.0F, 200.0F);
    ASSERT_TRUE(cylinder);
    EXPECT_NEAR(cylinder->mean, 0.25, 0.005);
    EXPECT_NEAR(cylinder->deviation, 0.25, 0.005);
}

}  // namespace
}  // namespace verglas
