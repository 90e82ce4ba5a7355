// SPDX-License-Identifier: GPL-3.0-or-later
// Quick pictures, shaded once for each square of Settings::pixel_size pixels, to all of their pixels.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "core/frame.h"
#include "core/scene/settings.h"

namespace verglas {

// Throws Error for settings of quick pictures that can't be rendered.
void check_pixel_size(const Settings& settings);

// The squares that hold the pixels of a rectangle.
inline Rect squares_of(const Rect& rect, int pixel_size) {
    return {rect.begin / pixel_size, (rect.end + pixel_size - 1) / pixel_size};
}

// The four squares around the centre of a pixel, and their bilinear weights. Squares outside of `rect`, which
// isn't empty, are those at its border.
struct SquaresAround {
    std::array<glm::ivec2, 4> squares;
    std::array<float, 4> weights;

    SquaresAround(glm::ivec2 pixel, int pixel_size, const Rect& rect) {
        const glm::vec2 place = (glm::vec2(pixel) + 0.5F) / static_cast<float>(pixel_size) - 0.5F;
        const glm::ivec2 lower(glm::floor(place));
        const glm::vec2 t = place - glm::vec2(lower);
        for (int i = 0; i < 4; ++i) {
            const glm::ivec2 corner(i & 1, i >> 1);
            squares[i] = glm::clamp(lower + corner, rect.begin, rect.end - 1);
            weights[i] = (corner.x == 1 ? t.x : 1.0F - t.x) * (corner.y == 1 ? t.y : 1.0F - t.y);
        }
    }
};

// A frame of `squares` to the pixels of rect: smooth, but not across steps in depth.
Frame upscaled(const Frame& coarse, const Rect& squares, const Rect& rect, int pixel_size);

}  // namespace verglas
