// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/material/model.h"

namespace verglas {
namespace {

// Mean cosine of a spherical Gaussian, by Simpson's rule over cosines.
double mean_cosine(double kappa) {
    constexpr int steps = 200000;
    double weight_sum = 0.0;
    double cosine_sum = 0.0;
    for (int i = 0; i <= steps; ++i) {
        const double cosine = -1.0 + 2.0 * i / steps;
        const double simpson = i == 0 || i == steps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        const double weight = simpson * std::exp(kappa * (cosine - 1.0));
        weight_sum += weight;
        cosine_sum += weight * cosine;
    }
    return cosine_sum / weight_sum;
}

// A user loses: the right width of every blur; all lobes go through these two functions.
TEST(SphericalGaussian, SpreadIsOneMinusTheMeanCosine) {
    for (const double kappa : {0.01, 0.05, 0.3, 1.0, 3.0, 9.9, 10.1, 40.0, 500.0}) {
        const double spread = 1.0 - mean_cosine(kappa);
        EXPECT_NEAR(model::spread_from_kappa(static_cast<float>(kappa)) / spread, 1.0, 2e-4) << kappa;
        EXPECT_NEAR(model::kappa_from_spread(static_cast<float>(spread)) / kappa, 1.0, 5e-3) << kappa;
    }
}

// A user loses: sharp glass, whose lobes must not drown in rounding.
TEST(SphericalGaussian, SharpLobesKeepTheirPrecision) {
    for (const float kappa : {1e4F, 1e6F, 1e8F})
        EXPECT_NEAR(model::kappa_from_spread(model::spread_from_kappa(kappa)) / kappa, 1.0F, 1e-4F) << kappa;
}

// A user loses: the environment where a pixel looks; u and v must run as Blender's.
TEST(Environment, DirectionsRoundTripAndMatchBlender) {
    EXPECT_NEAR(model::environment_uv({1, 0, 0}).x, 0.5F, 1e-6F);
    EXPECT_NEAR(model::environment_uv({0, 1, 0}).x, 0.25F, 1e-6F);
    EXPECT_NEAR(model::environment_uv({0, 0, 1}).y, 1.0F, 1e-6F);
    for (int i = 0; i < 50; ++i) {
        const glm::vec3 d =
            glm::normalize(glm::vec3(std::sin(i * 1.3F), std::cos(i * 2.1F), std::sin(i * 0.7F)));
        EXPECT_LT(glm::distance(model::environment_direction(model::environment_uv(d)), d), 1e-3F);
    }
}

// A user loses: straight edges in a clear view of a large map, which a coarse atan would bend by whole
// texels.
TEST(Environment, DirectionsAreExactToAHundredthOfATexel) {
    constexpr double texel = 1.0 / 8192.0;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 d =
            glm::normalize(glm::dvec3(std::sin(i * 1.3), std::cos(i * 2.1), std::sin(i * 0.7)));
        const glm::vec2 uv = model::environment_uv(glm::vec3(d));
        EXPECT_NEAR(uv.x, 0.5 - std::atan2(d.y, d.x) / (2.0 * glm::pi<double>()), 0.01 * texel) << i;
        EXPECT_NEAR(uv.y, 1.0 - std::acos(d.z) / glm::pi<double>(), 0.01 * texel) << i;
    }
}

}  // namespace
}  // namespace verglas
