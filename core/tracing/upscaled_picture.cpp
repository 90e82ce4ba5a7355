// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/upscaled_picture.h"

#include <array>
#include <span>
#include <vector>

#include "core/upscaling.h"

namespace verglas {

void UpscaledPicture::resolve(const Rect& tile, Frame& frame) const {
    thread_local std::vector<glm::ivec2> edges;
    edges.clear();
    glm::ivec2 pixel;
    for (pixel.y = tile.begin.y; pixel.y < tile.end.y; ++pixel.y) {
        for (pixel.x = tile.begin.x; pixel.x < tile.end.x; ++pixel.x) {
            const SquaresAround around(pixel, settings_.pixel_size, first_.rect);
            std::array<std::size_t, 4> places;
            for (int i = 0; i < 4; ++i) places[i] = first_.place(around.squares[i].x, around.squares[i].y);
            const Surface& surface = first_.surfaces[places[0]];
            glm::vec3 sum(0.0F);
            bool is_edge = false;
            for (int i = 0; i < 4; ++i) {
                is_edge = is_edge || first_.surfaces[places[i]].object != surface.object;
                sum += around.weights[i] * radiance_[places[i]];
            }
            if (is_edge)
                edges.push_back(pixel);
            else
                set(pixel, sum, surface, frame);
        }
    }
    look(edges, frame);
}

void UpscaledPicture::look(std::span<const glm::ivec2> pixels, Frame& frame) const {
    thread_local std::vector<glm::vec2> places;
    thread_local std::vector<BundleTracer::Sight> sights;
    places.clear();
    for (const glm::ivec2& pixel : pixels)
        places.push_back((glm::vec2(pixel) + 0.5F) / static_cast<float>(settings_.pixel_size));
    sights.resize(places.size());
    tracer_.look(places, sights);
    for (std::size_t i = 0; i < pixels.size(); ++i) set_edge(pixels[i], sights[i], frame);
}

// What the nearest squares show of the object that the pixel sees; of any, where none shows it.
void UpscaledPicture::set_edge(glm::ivec2 pixel, const BundleTracer::Sight& sight, Frame& frame) const {
    if (sight.object < 0) return set(pixel, sight.background, Surface::none(), frame);
    const SquaresAround around(pixel, settings_.pixel_size, first_.rect);
    glm::vec3 sum(0.0F);
    float weights = 0.0F;
    const Surface* surface = nullptr;
    for (int i = 0; i < 4; ++i) {
        const std::size_t place = first_.place(around.squares[i].x, around.squares[i].y);
        if (first_.surfaces[place].object != sight.object) continue;
        surface = &first_.surfaces[place];
        sum += around.weights[i] * radiance_[place];
        weights += around.weights[i];
    }
    if (weights > 0.0F) return set(pixel, sum / weights, *surface, frame);
    const std::size_t place = first_.place(around.squares[0].x, around.squares[0].y);
    set(pixel, radiance_[place], first_.surfaces[place], frame);
}

void UpscaledPicture::set(glm::ivec2 pixel, const glm::vec3& radiance, const Surface& surface,
                          Frame& frame) const {
    const std::size_t place = rect_.place(pixel);
    frame.combined[place] = glm::vec4(radiance, surface.object < 0 ? settings_.background_alpha : 1.0F);
    frame.normal_depth[place] = glm::vec4(surface.normal, surface.depth);
}

}  // namespace verglas
