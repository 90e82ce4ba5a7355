// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace verglas {

// Offset from the pixel's centre, in pixels, distributed like the Blackman-Harris filter of the given width,
// which reaches `width` to each side (as Cycles' does), for u uniform in [0, 1)^2. (1/2, 1/2) becomes the
// centre.
glm::vec2 blackman_harris_offset(glm::dvec2 u, float width);

}  // namespace verglas
