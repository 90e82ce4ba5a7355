// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace verglas {

// Rotation into the frame whose Z axis is the unit vector n (Duff et al. 2017).
inline glm::mat3 frame_of(const glm::vec3& n) {
    const float sign = std::copysign(1.0F, n.z);
    const float a = -1.0F / (sign + n.z);
    const float b = n.x * n.y * a;
    return {glm::vec3(1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x),
            glm::vec3(b, sign + n.y * n.y * a, -n.y), n};
}

}  // namespace verglas
