// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/pane_walk.h"

namespace verglas {
namespace {

// The same direction, or as the other side's frame has it.
glm::vec3 seen_from(bool is_near, const glm::vec3& d) { return is_near ? glm::vec3(d.x, d.y, -d.z) : d; }

}  // namespace

PaneWalk::PaneWalk(Ndf ndf, float near_alpha, float far_alpha, float eta, bool fresnel,
                   bool inner_reflections)
    : outside_(ndf, near_alpha, eta, fresnel, fresnel ? Reflected::All : Reflected::None),
      near_(ndf, near_alpha, 1.0F / eta, fresnel, fresnel ? Reflected::All : Reflected::None),
      far_(ndf, far_alpha, 1.0F / eta, fresnel, fresnel ? Reflected::All : Reflected::None),
      inner_reflections_(inner_reflections && fresnel) {}

std::optional<PaneWalk::Step> PaneWalk::sample(const glm::vec3& o,
                                               const std::array<glm::vec3, most_steps>& u) const {
    const auto entered = outside_.sample(o, glm::vec2(u[0]), RoughInterface::Event::Refract);
    if (!entered) return std::nullopt;
    glm::vec3 d = entered->direction;
    float weight = entered->weight;
    for (int step = 1; step < most_steps; ++step) {
        const bool is_near = d.z > 0.0F;
        const glm::vec3 inside = seen_from(is_near, -d);
        const RoughInterface& side = is_near ? near_ : far_;
        const auto met = inner_reflections_
                             ? side.sample(inside, glm::vec2(u[step]), u[step].z)
                             : side.sample(inside, glm::vec2(u[step]), RoughInterface::Event::Refract);
        if (!met) return std::nullopt;
        weight *= met->weight;
        const bool left = met->direction.z < 0.0F;
        const glm::vec3 before = -d;
        d = seen_from(is_near, met->direction);
        if (left) return Step{d, weight, before, is_near};
    }
    return std::nullopt;
}

}  // namespace verglas
