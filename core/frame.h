// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <string>

#include "core/math/unfilled.h"

namespace verglas {

// A finished picture of a region, scene-linear, row 0 at the bottom.
struct Frame {
    glm::ivec2 size{0};
    Unfilled<glm::vec4> combined;      // premultiplied alpha
    Unfilled<glm::vec4> normal_depth;  // world space and along the camera's axis; 0 and 1e10 where nothing is
    double seconds = 0.0;              // passes and readback
    // GPU time by pass, summed over samples; "readback" is wall time.
    std::map<std::string, double> pass_seconds;
    // Wall time of uploads and precomputation, 0 where nothing was new.
    std::map<std::string, double> prepare_seconds;
};

}  // namespace verglas
