// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/math/pixel_filter.h"

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/math/low_discrepancy.h"

namespace verglas {
namespace {

// Integral of the Blackman-Harris window from 0 to x, of all: x in 0 … 1, window's centre at 1/2.
double cumulative(double x) {
    const double t = 2.0 * glm::pi<double>() * x;
    return x +
           (-0.48829 * std::sin(t) + 0.14128 * std::sin(2.0 * t) / 2.0 - 0.01168 * std::sin(3.0 * t) / 3.0) /
               (2.0 * glm::pi<double>() * 0.35875);
}

// Where a share u of the window lies to the left, by bisection.
double inverse_cumulative(double u) {
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (cumulative(middle) < u ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace

glm::vec2 blackman_harris_offset(int sample, float width) {
    const glm::dvec2 u = r2_point(static_cast<std::uint64_t>(sample));
    const glm::dvec2 place(inverse_cumulative(u.x), inverse_cumulative(u.y));
    return glm::vec2((2.0 * place - 1.0) * static_cast<double>(width));
}

}  // namespace verglas
