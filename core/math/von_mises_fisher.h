// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>

namespace verglas {

// A unit direction about +Z, drawn from the von Mises-Fisher distribution of concentration kappa > 0: a
// spherical Gaussian. u: in [0, 1)^2.
inline glm::vec3 sample_vmf(float kappa, glm::vec2 u) {
    // Inverse of the distribution of 1 - cos theta, which keeps its precision for narrow ones.
    const float versine = std::min(-std::log1p(-u.x * (1.0F - std::exp(-2.0F * kappa))) / kappa, 2.0F);
    const float sine = std::sqrt(versine * (2.0F - versine));
    const float phi = 2.0F * glm::pi<float>() * u.y;
    return {sine * std::cos(phi), sine * std::sin(phi), 1.0F - versine};
}

}  // namespace verglas
