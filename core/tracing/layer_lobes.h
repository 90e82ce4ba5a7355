// SPDX-License-Identifier: GPL-3.0-or-later
// What a thin layer makes of a ray that meets it, as lobes of light.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "core/material/model.h"
#include "core/tracing/traced_scene.h"

namespace verglas {

struct LayerLobe {
    enum class Way {
        Through,     // a pane, straight on in the mean
        Mirrored,    // by the outer side
        FromWithin,  // back through it
    };
    Way way;
    model::Lobe lobe;
    glm::vec3 color;  // factor on the lobe's energy

    // Rather than what is seen through a pane, or of the base under a coating.
    bool is_reflection(const Material& material) const {
        return way == Way::Mirrored || (way == Way::FromWithin && material.kind == MaterialKind::Pane);
    }
};

class LayerLobes {
  public:
    // Of a coating; a pane has a transmitted one, two fans, and a mirrored one.
    static constexpr std::size_t most_lobes =
        std::max(2 * (2 * model::COATING_PARTS + model::COATING_SLICES), 2 + 2 * model::FAN_RAYS);

    // d: unit, the ray's direction; n: unit, toward where it comes from; entering: from the side that the
    // mesh's normals show to.
    static LayerLobes of(const TracedScene& scene, const Hit& hit, const glm::vec3& d, const glm::vec3& n,
                         bool entering);

    std::span<const LayerLobe> all() const { return {lobes_.data(), count_}; }

  private:
    // By parts: a lobe that is copied as it was written waits for its memory, which took half of a coating's
    // time.
    void add(LayerLobe::Way way, const model::Lobe& lobe, const glm::vec3& color) {
        if (lobe.energy <= 0.0F) return;
        LayerLobe& added = lobes_[count_++];
        added.way = way;
        added.lobe.energy = lobe.energy;
        added.lobe.spread = lobe.spread;
        for (int axis = 0; axis < 3; ++axis) {
            added.lobe.direction[axis] = lobe.direction[axis];
            added.color[axis] = color[axis];
        }
    }
    void add(LayerLobe::Way way, const model::Fan& fan, const glm::vec3& color);
    void add_pane(const TracedScene& scene, const Material& material, const model::Pane& pane,
                  const glm::vec3& d, const glm::vec3& n);
    void add_coated(const TracedScene& scene, const Hit& hit, const glm::vec3& d, const glm::vec3& n);

    std::array<LayerLobe, most_lobes> lobes_;
    std::size_t count_ = 0;
};

}  // namespace verglas
