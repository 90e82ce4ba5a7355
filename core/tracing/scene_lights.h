// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "core/scene/scene.h"

namespace verglas {

// Scene::lights for path tracing. A point, or a sun without an angle, is met by no ray; the others are a
// sphere in space or a cone of directions.
class SceneLights {
  public:
    explicit SceneLights(const Scene& scene) : lights_(scene.lights) {}

    std::size_t size() const { return lights_.size(); }

    // A light as it is seen from a point along one direction.
    struct Sample {
        glm::vec3 direction;  // unit, toward it
        float distance;       // infinite for a sun
        glm::vec3 light;      // radiance, or of what is met by no ray its irradiance
        float pdf;            // per steradian, with which the direction is drawn; 0 of what is met by no ray
    };
    // Draws a direction evenly from those in which the light is seen. u: in [0, 1)^2.
    Sample sample(std::size_t light, const glm::vec3& from, glm::vec2 u) const;
    // What sample() would return with this unit direction; none where the light isn't met.
    std::optional<Sample> at(std::size_t light, const glm::vec3& from, const glm::vec3& direction) const;

  private:
    const std::vector<Light>& lights_;
};

}  // namespace verglas
