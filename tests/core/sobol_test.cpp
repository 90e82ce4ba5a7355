// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/math/sobol.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

namespace verglas {
namespace {

// A researcher loses: the fast convergence of a Sobol sequence. The expected point is SciPy's (qmc.Sobol, not
// scrambled, its point 13, which in the order of Gray's code is our 11).
TEST(Sobol, IsTheSequenceOfJoeAndKuo) {
    constexpr std::array<double, sobol_dimensions> expected = {0.8125, 0.6875, 0.8125, 0.0625, 0.4375, 0.9375,
                                                               0.5625, 0.5625, 0.5625, 0.4375, 0.8125, 0.9375,
                                                               0.0625, 0.8125, 0.1875, 0.5625};
    for (int d = 0; d < sobol_dimensions; ++d) EXPECT_EQ(sobol_coordinate(11, d) * 0x1p-32, expected[d]) << d;
}

// A researcher loses: means without bias and strata that are all met, in the first coordinates and the later
// ones.
TEST(Sobol, ScramblingKeepsTheStrata) {
    constexpr unsigned count = 256;
    for (const int dimension : {0, 1, 7, 15, 16, 23, 40}) {
        std::set<int> strata;
        for (unsigned i = 0; i < count; ++i) {
            const float x = SobolPoint(5, i, 1)[dimension];
            ASSERT_GE(x, 0.0F);
            ASSERT_LT(x, 1.0F);
            strata.insert(int(x * float(count)));
        }
        EXPECT_EQ(strata.size(), count) << dimension;
    }
    std::set<int> cells;  // 16 x 16
    for (unsigned i = 0; i < count; ++i) {
        const glm::vec2 p = SobolPoint(5, i, 1).pair(0);
        cells.insert(int(p.x * 16.0F) * 16 + int(p.y * 16.0F));
    }
    EXPECT_EQ(cells.size(), count);
}

// A researcher loses: noise that differs from pixel to pixel and from seed to seed.
TEST(Sobol, PixelsAndSeedsDiffer) {
    double correlation_of_pixels = 0.0;
    double correlation_of_seeds = 0.0;
    double correlation_of_runs = 0.0;
    constexpr int count = 4096;
    for (int i = 0; i < count; ++i) {
        const SobolPoint point(i, 3, 0);
        correlation_of_pixels += (point[2] - 0.5) * (SobolPoint(i + 1, 3, 0)[2] - 0.5) * 12.0 / count;
        correlation_of_seeds += (point[2] - 0.5) * (SobolPoint(i, 3, 1)[2] - 0.5) * 12.0 / count;
        correlation_of_runs += (point[2] - 0.5) * (point[2 + sobol_dimensions] - 0.5) * 12.0 / count;
    }
    EXPECT_NEAR(correlation_of_pixels, 0.0, 0.06);
    EXPECT_NEAR(correlation_of_seeds, 0.0, 0.06);
    EXPECT_NEAR(correlation_of_runs, 0.0, 0.06);
}

}  // namespace
}  // namespace verglas
