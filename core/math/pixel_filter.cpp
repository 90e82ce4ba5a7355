// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/math/pixel_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

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

constexpr int table_steps = 1024;

const std::array<double, table_steps + 1>& inverse_table() {
    static const auto table = [] {
        std::array<double, table_steps + 1> values{};
        for (int i = 0; i <= table_steps; ++i)
            values[i] = inverse_cumulative(static_cast<double>(i) / table_steps);
        return values;
    }();
    return table;
}

double interpolate_inverse(double u) {
    const double position = u * table_steps;
    const int i = std::min(static_cast<int>(position), table_steps - 1);
    return glm::mix(inverse_table()[i], inverse_table()[i + 1], position - i);
}

}  // namespace

glm::vec2 blackman_harris_offset(glm::dvec2 u, float width) {
    const glm::dvec2 place(interpolate_inverse(u.x), interpolate_inverse(u.y));
    return glm::vec2((2.0 * place - 1.0) * static_cast<double>(width));
}

float blackman_harris_share(float low, float high, float width) {
    const auto below = [width](float offset) {
        return cumulative(std::clamp(0.5 + 0.5 * offset / static_cast<double>(width), 0.0, 1.0));
    };
    return static_cast<float>(below(high) - below(low));
}

}  // namespace verglas
