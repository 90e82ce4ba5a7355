// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/upscaling.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/error.h"

namespace verglas {
namespace {

// As a share; more is a step from one surface to another.
constexpr float depth_step = 0.05F;

}  // namespace

void check_pixel_size(const Settings& settings) {
    if (settings.pixel_size < 1) throw Error("Squares of pixels need at least one.");
    if (settings.pixel_size > 1 && settings.samples > 1) throw Error("Quick pictures have one sample.");
}

Frame upscaled(const Frame& coarse, const Rect& squares, const Rect& rect, int pixel_size) {
    Frame frame;
    frame.size = rect.size();
    frame.combined.resize(rect.pixels());
    frame.normal_depth.resize(rect.pixels());
    frame.seconds = coarse.seconds;
    frame.pass_seconds = coarse.pass_seconds;
    frame.prepare_seconds = coarse.prepare_seconds;
    const auto fill = [&](glm::ivec2 pixel) {
        const SquaresAround around(pixel, pixel_size, squares);
        const std::size_t nearest =
            squares.place(glm::clamp(pixel / pixel_size, squares.begin, squares.end - 1));
        const glm::vec4& surface = coarse.normal_depth[nearest];
        glm::vec4 sum(0.0F);
        float weights = 0.0F;
        for (int i = 0; i < 4; ++i) {
            const std::size_t place = squares.place(around.squares[i]);
            if (std::abs(coarse.normal_depth[place].w - surface.w) > depth_step * surface.w) continue;
            sum += around.weights[i] * coarse.combined[place];
            weights += around.weights[i];
        }
        frame.combined[rect.place(pixel)] = sum / weights;
        frame.normal_depth[rect.place(pixel)] = surface;
    };
    tbb::parallel_for(rect.begin.y, rect.end.y, [&](int y) {
        for (int x = rect.begin.x; x < rect.end.x; ++x) fill({x, y});
    });
    return frame;
}

}  // namespace verglas
