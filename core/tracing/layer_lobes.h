// SPDX-License-Identifier: GPL-3.0-or-later
// What a thin layer makes of a ray that meets it, as lobes of light.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "core/material/model.h"
#include "core/tracing/traced_scene.h"

namespace verglas {

struct LayerLobe {
    bool reflected;  // else it goes through, straight on in the mean
    model::Lobe lobe;
    glm::vec3 color;  // factor on the lobe's energy
};

class LayerLobes {
  public:
    // d: unit, the ray's direction; n: unit, toward where it comes from; entering: from the side that the
    // mesh's normals show to.
    static LayerLobes of(const TracedScene& scene, const Hit& hit, const glm::vec3& d, const glm::vec3& n,
                         bool entering);

    std::span<const LayerLobe> all() const { return {lobes_.data(), count_}; }

  private:
    static constexpr std::size_t most = 18;

    void add(const LayerLobe& lobe);
    void add_pane(const TracedScene& scene, const Hit& hit, const glm::vec3& d, const glm::vec3& n,
                  bool entering);

    std::array<LayerLobe, most> lobes_;
    std::size_t count_ = 0;
};

}  // namespace verglas
