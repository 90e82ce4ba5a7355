// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "tests/core/model_device.h"

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

class SphericalGaussian : public OnDevice {};
ON_BOTH_DEVICES(SphericalGaussian);

// A user loses: the right width of every blur; all lobes go through these two functions.
TEST_P(SphericalGaussian, SpreadIsOneMinusTheMeanCosine) {
    for (const double kappa : {0.01, 0.05, 0.3, 1.0, 3.0, 9.9, 10.1, 40.0, 500.0}) {
        const double spread = 1.0 - mean_cosine(kappa);
        const Answer answer = ask(MODEL_FUNCTION(spherical_gaussian), {{kappa, spread, 0.0, 0.0}, {}, {}});
        EXPECT_NEAR(answer.a.x / spread, 1.0, 2e-4) << kappa;
        EXPECT_NEAR(answer.a.y / kappa, 1.0, 5e-3) << kappa;
    }
}

// A user loses: sharp glass, whose lobes must not drown in rounding.
TEST_P(SphericalGaussian, SharpLobesKeepTheirPrecision) {
    for (const float kappa : {1e4F, 1e6F, 1e8F}) {
        const Answer answer = ask(MODEL_FUNCTION(spherical_gaussian), {{kappa, 0.5F, 0.0F, 0.0F}, {}, {}});
        EXPECT_NEAR(answer.a.z / kappa, 1.0F, 1e-4F) << kappa;
    }
}

class EnvironmentPlace : public OnDevice {
  protected:
    static std::vector<Answer> places(const std::vector<glm::dvec3>& directions) {
        std::vector<Question> questions;
        for (const glm::dvec3& d : directions) questions.push_back({glm::vec4(d, 0.0), {}, {}});
        return ask(MODEL_FUNCTION(environment_place), questions);
    }

    static std::vector<glm::dvec3> many_directions(int count) {
        std::vector<glm::dvec3> directions;
        for (int i = 0; i < count; ++i)
            directions.push_back(
                glm::normalize(glm::dvec3(std::sin(i * 1.3), std::cos(i * 2.1), std::sin(i * 0.7))));
        return directions;
    }
};
ON_BOTH_DEVICES(EnvironmentPlace);

// A user loses: the environment where a pixel looks; u and v must run as Blender's.
TEST_P(EnvironmentPlace, RoundTripsAndMatchesBlender) {
    const auto axes = places({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    EXPECT_NEAR(axes[0].a.x, 0.5F, 1e-6F);
    EXPECT_NEAR(axes[1].a.x, 0.25F, 1e-6F);
    EXPECT_NEAR(axes[2].a.y, 1.0F, 1e-6F);
    const auto directions = many_directions(50);
    const auto answers = places(directions);
    for (std::size_t i = 0; i < directions.size(); ++i)
        EXPECT_LT(glm::distance(glm::dvec3(answers[i].b), directions[i]), 1e-3);
}

// A user loses: straight edges in a clear view of a large map, which a coarse atan would bend by whole
// texels.
TEST_P(EnvironmentPlace, IsExactToAHundredthOfATexel) {
    constexpr double texel = 1.0 / 8192.0;
    const auto directions = many_directions(2000);
    const auto answers = places(directions);
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const glm::dvec3& d = directions[i];
        EXPECT_NEAR(answers[i].a.x, 0.5 - std::atan2(d.y, d.x) / (2.0 * glm::pi<double>()), 0.01 * texel)
            << i;
        EXPECT_NEAR(answers[i].a.y, 1.0 - std::acos(d.z) / glm::pi<double>(), 0.01 * texel) << i;
    }
}

}  // namespace
}  // namespace verglas
