// SPDX-License-Identifier: GPL-3.0-or-later
// Light in a thin layer, followed from side to side by chance, in the frame of its near side: n = +Z, and o,
// the direction to the viewer, above it.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "core/material/layered_surface.h"

namespace verglas {

// The end of a way through a pane or a coating.
struct LayerWalk {
    // Surfaces that light meets at most; what is left then is lost.
    static constexpr int most_steps = 18;

    glm::vec3 direction;  // where the light comes from
    glm::vec3 weight;     // of all events
    glm::vec3 o;          // toward the viewer, before the last interface
    bool is_near;         // side of the last interface
};

// A way through a layer's near side, and back to it or through a pane's far side. u: three numbers in [0, 1)
// for each step. bounces: how often light may meet a coating's base. None where the light is lost.
std::optional<LayerWalk> walk_layer(const LayeredSurface& layer, int bounces, const glm::vec3& o,
                                    const std::array<glm::vec3, LayerWalk::most_steps>& u);

}  // namespace verglas
