// SPDX-License-Identifier: GPL-3.0-or-later
// Light in a thin pane, followed from side to side by chance, in the frame of its near side: n = +Z, and o,
// the direction to the viewer, above it.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "core/material/microfacet.h"

namespace verglas {

class PaneWalk {
  public:
    // Interfaces that light meets at most; what is left then is lost.
    static constexpr int most_steps = 16;

    // eta: of the glass to its surroundings. Sides of the same distribution with these widths. fresnel: as
    // RoughInterface's; without it, or without inner_reflections, nothing that they reflect is followed.
    PaneWalk(Ndf ndf, float near_alpha, float far_alpha, float eta, bool fresnel, bool inner_reflections);

    struct Step {
        glm::vec3 direction;  // where the light comes from
        float weight;         // of all events so far
        glm::vec3 o;          // toward the viewer, before the last interface
        bool is_near;         // side of the last interface
    };
    // A way through the near side, and back to it or through the far side. u: three numbers in [0, 1) of each
    // step. None where the light is lost.
    std::optional<Step> sample(const glm::vec3& o, const std::array<glm::vec3, most_steps>& u) const;

  private:
    RoughInterface outside_;
    RoughInterface near_;  // from within
    RoughInterface far_;
    bool inner_reflections_;
};

}  // namespace verglas
