// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "core/scene/scene.h"

namespace verglas {

// The unfiltered environment for path tracing: radiance, and directions drawn in proportion to it.
class EnvironmentLight {
  public:
    explicit EnvironmentLight(const Scene& scene);

    // From a unit direction in world space; bilinear between texels, as Cycles and the OpenGL device.
    glm::vec3 radiance(const glm::vec3& direction) const;

    struct Sample {
        glm::vec3 direction;
        float pdf;  // per steradian
    };
    // u in [0, 1)^2.
    Sample sample(glm::vec2 u) const;
    float pdf(const glm::vec3& direction) const;

  private:
    const glm::vec3& texel(int x, int y) const;
    float uv_pdf(glm::vec2 uv) const;

    std::shared_ptr<const EnvironmentMap> map_;
    glm::vec3 color_;
    glm::mat3 world_to_map_;
    std::vector<float> rows_;     // cumulated shares of the rows, from 0 to 1
    std::vector<float> columns_;  // the same of the columns of every row
};

}  // namespace verglas
