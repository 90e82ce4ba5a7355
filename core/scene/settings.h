// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace verglas {

// How light crosses an object; shaders/refraction.frag.glsl has them. The last two are baselines
// whose interfaces refract sharply.
enum class Transport { Bundle, Paper, Single, DepthMip, Specular };
enum class Intersection { Newton, March };
// Where the lobes of interfaces come from: from tables of Walter et al.'s BSDF, or in closed form, with
// nothing to build or to load (shaders/lib/analytic_lobe.glsl).
enum class Lobes { Table, Analytic };
// What becomes of rays beyond the critical angle: as TIR_* of shaders/lib/constants.glsl; Bounce
// (Transport::Bundle and Intersection::Newton, else as Clamp) follows all that is reflected inside, as
// shaders/bounce.glsl does it.
enum class Tir : int { None, Incident, Clamp, Bounce };

// Roughness of the back faces where a texture makes it vary: the texture's mean, or classes of roughness by
// the part of the back that each covers (de Rousiers et al. 2012, section 5.1), for the first three ways.
enum class BackRoughness { Simple, Coverage };

// Pixels from the lower left.
struct Rect {
    glm::ivec2 begin{0};
    glm::ivec2 end{0};  // exclusive

    bool operator==(const Rect&) const = default;
    glm::ivec2 size() const { return end - begin; }
    std::size_t pixels() const { return std::size_t(size().x) * size().y; }
    // Of a pixel, among all row by row.
    std::size_t place(glm::ivec2 pixel) const {
        const glm::ivec2 inside = pixel - begin;
        return std::size_t(inside.y) * size().x + inside.x;
    }
    bool empty() const { return end.x <= begin.x || end.y <= begin.y; }
    bool contains(glm::ivec2 pixel) const {
        return pixel.x >= begin.x && pixel.y >= begin.y && pixel.x < end.x && pixel.y < end.y;
    }
    bool overlaps(const Rect& other) const {
        return begin.x < other.end.x && other.begin.x < end.x && begin.y < other.end.y &&
               other.begin.y < end.y;
    }
    Rect intersected(const Rect& other) const {
        return {glm::max(begin, other.begin), glm::min(end, other.end)};
    }
    Rect united(const Rect& other) const { return {glm::min(begin, other.begin), glm::max(end, other.end)}; }
};

// The part of a frame that is rendered: all of it without a region.
inline Rect rendered_rect(glm::ivec2 size, const std::optional<Rect>& region) {
    const Rect frame{glm::ivec2(0), size};
    return region ? region->intersected(frame) : frame;
}

// Which light a tracer follows.
enum class PathMode {
    TwoInterface,  // enter, leave, and straight into the environment: what the paper compares with
    Full,          // reflection, inner reflections, re-entry
};

struct Settings {
    glm::ivec2 size{512};
    std::optional<Rect> region;  // the part that is shaded and returned
    // Pixels along each side of the squares that are shaded as one, for quick pictures of one sample;
    // outlines are still those of the pixels.
    int pixel_size = 1;
    int samples = 16;
    float filter_width = 1.5F;  // of the Blackman-Harris filter, pixels
    Transport transport = Transport::Bundle;
    Intersection intersection = Intersection::Newton;
    Lobes lobes = Lobes::Table;
    Tir tir = Tir::Clamp;
    BackRoughness back_roughness = BackRoughness::Coverage;
    int roughness_classes = 4;  // at most, of a texture: 2 … 8
    bool reflection = true;
    // Of the world itself, where no object is before it. The colour is premultiplied by it.
    float background_alpha = 1.0F;
    float background_spread = 0.0F;  // of the lobe that blurs it: 1 - its mean resultant length
    // Of TracedRenderer.
    PathMode paths = PathMode::Full;
    int max_interfaces = 8;  // that a ray of the first sample crosses
    int threads = 0;         // 0: one for each core

    bool operator==(const Settings&) const = default;
};

}  // namespace verglas
