// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "tests/core/model_device.h"
#include "tests/core/reference_lobes.h"

namespace verglas {
namespace {

using glm::dvec3;
using glm::vec3;
using glm::vec4;

constexpr double ior = 1.5;
const vec3 up(0.0F, 0.0F, 1.0F);

// Downward at an angle to the normal `up`, in the plane of X and Z.
vec3 incident(double theta) { return {float(std::sin(theta)), 0.0F, float(-std::cos(theta))}; }

class Specular : public OnDevice {
  protected:
    static model::Lobe refraction(double eta, bool fresnel, const vec3& d, const vec3& n, int tir) {
        return lobe_of(ask(MODEL_FUNCTION(sharp_refraction),
                           {vec4(d, float(eta)), vec4(n, fresnel ? 1.0F : 0.0F), {float(tir), 0, 0, 0}}));
    }
    static model::Lobe reflection(double eta, const vec3& d, const vec3& n) {
        return lobe_of(ask(MODEL_FUNCTION(sharp_reflection), {vec4(d, float(eta)), vec4(n, 0.0F), {}}));
    }
};
ON_BOTH_DEVICES(Specular);

// Through the unit sphere a ray at offset b is turned twice by theta_i - theta_t, sin theta_i = b = eta sin
// theta_t, and loses F(theta_i) both times, as seen from outside. A user loses: a baseline that shows what
// sharp glass shows.
TEST_P(Specular, SphereTurnsRaysBySnellsLaw) {
    for (const double b : {0.0, 0.2, 0.5, 0.8, 0.95, 0.999}) {
        const double theta_i = std::asin(b);
        const double turn = 2.0 * (theta_i - std::asin(b / ior));
        const vec3 d(0.0F, 0.0F, -1.0F);
        const vec3 p(float(b), 0.0F, float(std::cos(theta_i)));
        const model::Lobe inside = refraction(ior, true, d, p, model::TIR_NONE);
        const vec3 outward = p - 2.0F * glm::dot(p, inside.direction) * inside.direction;
        const model::Lobe exit = refraction(1.0 / ior, true, inside.direction, -outward, model::TIR_NONE);
        const vec3 expected(float(-std::sin(turn)), 0.0F, float(-std::cos(turn)));
        EXPECT_LE(glm::distance(exit.direction, expected), 2e-3F) << b;
        const double through = 1.0 - reference::fresnel(std::cos(theta_i), ior);
        EXPECT_NEAR(inside.energy, through, 1e-4) << b;
        EXPECT_NEAR(exit.energy, through, 2e-3) << b;
    }
}

// A user loses: panes of glass that show the world behind them where it is.
TEST_P(Specular, SlabKeepsDirections) {
    for (const double theta : {0.0, 0.3, 0.9, 1.4}) {
        const vec3 d = incident(theta);
        const model::Lobe inside = refraction(ior, true, d, up, model::TIR_NONE);
        const model::Lobe exit = refraction(1.0 / ior, true, inside.direction, up, model::TIR_NONE);
        EXPECT_LE(glm::distance(exit.direction, d), 1e-5F) << theta;
    }
}

// A user loses: the choice of what becomes of totally reflected light, of which Fresnel's formula leaves
// nothing.
TEST_P(Specular, BeyondTheCriticalAngle) {
    const float eta = 1.0F / float(ior);
    const vec3 d = incident(1.0);
    EXPECT_EQ(refraction(eta, false, d, up, model::TIR_NONE).energy, 0.0F);
    const model::Lobe onward = refraction(eta, false, d, up, model::TIR_INCIDENT);
    EXPECT_EQ(onward.energy, 1.0F);
    EXPECT_EQ(onward.direction, d);
    const model::Lobe clamped = refraction(eta, false, d, up, model::TIR_CLAMP);
    EXPECT_EQ(clamped.energy, 1.0F);
    EXPECT_LE(glm::distance(clamped.direction, vec3(1.0F, 0.0F, 0.0F)), 1e-6F);
    for (const int tir : {model::TIR_NONE, model::TIR_INCIDENT, model::TIR_CLAMP})
        EXPECT_NEAR(refraction(eta, true, d, up, tir).energy, 0.0F, 1e-6F);
}

// A user loses: pictures without black or burnt-out pixels where normals face away from a ray.
TEST_P(Specular, NormalsThatFaceAway) {
    for (const float eta : {1.0F / float(ior), float(ior)}) {
        for (const vec3 d : {vec3(1.0F, 0.0F, 0.0F), up}) {
            const model::Lobe lobe = refraction(eta, true, d, up, model::TIR_CLAMP);
            EXPECT_NEAR(lobe.energy, 0.0F, 1e-4F);
            EXPECT_NEAR(glm::length(lobe.direction), 1.0F, 1e-4F);
        }
    }
}

// A user loses: mirror images in sharp glass, where and as bright as they belong.
TEST_P(Specular, Reflection) {
    const model::Lobe mirror = reflection(ior, incident(0.7), up);
    EXPECT_LE(glm::distance(mirror.direction, vec3(float(std::sin(0.7)), 0.0F, float(std::cos(0.7)))), 1e-6F);
    EXPECT_NEAR(mirror.energy, reference::fresnel(std::cos(0.7), ior), 1e-5);
}

}  // namespace
}  // namespace verglas
