// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace verglas {

// Offset of a sample from the pixel's centre, in pixels, distributed like the Blackman-Harris filter of the
// given width, which reaches `width` to each side (as Cycles' does). Sample 0 lies at the centre.
glm::vec2 blackman_harris_offset(int sample, float width);

}  // namespace verglas
