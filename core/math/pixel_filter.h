// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace verglas {

// Offset from the pixel's centre, in pixels, distributed like the Blackman-Harris filter of the given width,
// which reaches `width` to each side (as Cycles' does), for u uniform in [0, 1)^2. (1/2, 1/2) becomes the
// centre.
glm::vec2 blackman_harris_offset(glm::dvec2 u, float width);

// The share of these offsets, 0 … 1, that lies between two values, along one axis.
float blackman_harris_share(float low, float high, float width);

}  // namespace verglas
