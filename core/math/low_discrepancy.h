// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace verglas {

// Point `index` of the R2 sequence in [0, 1)^2 (Roberts 2018: additive recurrence with the plastic number),
// begun at (1/2, 1/2).
inline glm::dvec2 r2_point(std::uint64_t index) {
    constexpr double plastic = 1.32471795724474602596;
    const glm::dvec2 step(1.0 / plastic, 1.0 / (plastic * plastic));
    return glm::fract(0.5 + static_cast<double>(index) * step);
}

}  // namespace verglas
