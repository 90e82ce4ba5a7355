// SPDX-License-Identifier: GPL-3.0-or-later
// What a coating makes of light from one direction, as lobes: see shaders/lib/coated.glsl.
#pragma once

#include <compare>
#include <glm/glm.hpp>
#include <vector>

#include "core/scene/scene.h"

namespace verglas {

// Least and greatest of a surface's roughness, 0 … MAX_ROUGHNESS.
struct RoughnessRange {
    float least;
    float greatest;

    auto operator<=>(const RoughnessRange&) const = default;
};

// All that a table depends on.
struct CoatingKey {
    explicit CoatingKey(const Material& material);

    float ior;
    bool fresnel;
    bool diffuse;
    RoughnessRange outer;
    RoughnessRange base;

    auto operator<=>(const CoatingKey&) const = default;
};

// Light is followed from the viewer through both rough interfaces (LayeredSurface, the path tracer's own
// model), on the same Sobol points for each node. At each interface it is split in what is reflected and what
// is refracted, so that all points bring light of each bounce.
struct CoatingTable {
    // Computes it, in parallel.
    static CoatingTable build(const CoatingKey& key);

    // Roughnesses on the outer side, and on the base for each of them: rows, whose first is 0.
    model::CoatingTable layout;
    // Row after row, COATING_ITEMS * COATING_ANGLES each.
    std::vector<glm::vec4> nodes;
};

}  // namespace verglas
