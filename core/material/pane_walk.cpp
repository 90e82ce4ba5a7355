// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/pane_walk.h"

namespace verglas {
namespace {

// The same direction, or as the near side's frame from within has it.
glm::vec3 seen_from(bool is_near, const glm::vec3& d) { return is_near ? glm::vec3(d.x, d.y, -d.z) : d; }

}  // namespace

std::optional<PaneWalk> walk_pane(const LayeredSurface& pane, const glm::vec3& o,
                                  const std::array<glm::vec3, PaneWalk::most_steps>& u) {
    const auto entered = pane.outside().sample(o, glm::vec2(u[0]), RoughInterface::Event::Refract);
    if (!entered) return std::nullopt;
    glm::vec3 d = entered->direction;
    float weight = entered->weight;
    for (int step = 1; step < PaneWalk::most_steps; ++step) {
        const bool is_near = d.z > 0.0F;
        const RoughInterface& side = is_near ? pane.near() : *pane.far();
        const auto met = side.sample(seen_from(is_near, -d), glm::vec2(u[step]), u[step].z);
        if (!met) return std::nullopt;
        weight *= met->weight;
        const glm::vec3 before = -d;
        d = seen_from(is_near, met->direction);
        if (met->direction.z < 0.0F) return PaneWalk{d, weight, before, is_near};
    }
    return std::nullopt;
}

}  // namespace verglas
