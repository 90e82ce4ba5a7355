// SPDX-License-Identifier: GPL-3.0-or-later
// Light in a thin pane, followed from side to side by chance, in the frame of its near side: n = +Z, and o,
// the direction to the viewer, above it.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "core/material/layered_surface.h"

namespace verglas {

// The end of a way through a pane.
struct PaneWalk {
    // Interfaces that light meets at most; what is left then is lost.
    static constexpr int most_steps = 16;

    glm::vec3 direction;  // where the light comes from
    float weight;         // of all events
    glm::vec3 o;          // toward the viewer, before the last interface
    bool is_near;         // side of the last interface
};

// A way through a pane's near side, and back to it or through the far side. u: three numbers in [0, 1) of
// each step. None where the light is lost.
std::optional<PaneWalk> walk_pane(const LayeredSurface& pane, const glm::vec3& o,
                                  const std::array<glm::vec3, PaneWalk::most_steps>& u);

}  // namespace verglas
