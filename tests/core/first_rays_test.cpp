// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/first_rays.h"

#include <gtest/gtest.h>

#include <cmath>

namespace verglas {
namespace {

// A user loses: rough glass that refracts where path-traced glass does, and blurs as much: rays at the mean
// distance of the lobe's, in opposite pairs, have its mean vector.
TEST(FirstRays, OfAPatternHaveTheLobesMean) {
    for (const bool is_fine : {false, true}) {
        float distances = 0.0F;
        std::size_t count = 0;
        for (int pixel = 0; pixel < 4; ++pixel) {
            glm::vec2 sideways(0.0F);
            for (const BundleRay& ray : first_rays({6 + pixel % 2, 3 + pixel / 2}, is_fine)) {
                EXPECT_GT(ray.squared_distance, 0.0F);
                EXPECT_NEAR(glm::length(ray.azimuth), 1.0F, 1e-5F);
                distances += ray.squared_distance;
                sideways += std::sqrt(ray.squared_distance) * ray.azimuth;
                ++count;
            }
            EXPECT_NEAR(glm::length(sideways), 0.0F, 1e-5F);
        }
        EXPECT_EQ(count, is_fine ? 16U : 8U);
        EXPECT_NEAR(distances / static_cast<float>(count), 1.0F, 1e-5F);
    }
}

}  // namespace
}  // namespace verglas
