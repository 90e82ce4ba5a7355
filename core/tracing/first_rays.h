// SPDX-License-Identifier: GPL-3.0-or-later
// Which rays stand for a pixel's front lobe in the first sample of a traced picture (method: 5.3).
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace verglas {

// A ray's place in a lobe.
struct BundleRay {
    // From the axis, in units of its mean over the lobe: rays at 1 - cos = squared_distance * spread have the
    // lobe's mean vector together.
    float squared_distance;
    glm::vec2 azimuth;  // cosine and sine
};

// One or two pairs of opposite rays. Those of neighbouring pixels are turned against each other and stand for
// other parts of the lobe, in a pattern of 2 x 2 pixels, so that their average (surface_average.h) has four
// times as many.
// is_fine: whether what the rays meet changes over short ways, as painted roughness; then there are two
// pairs.
std::span<const BundleRay> first_rays(glm::ivec2 pixel, bool is_fine);

}  // namespace verglas
