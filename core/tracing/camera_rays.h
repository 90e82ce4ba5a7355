// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "core/scene/scene.h"
#include "core/tracing/ray_scene.h"

namespace verglas {

// The rays of a camera through the pixels of a frame of the given size, which need not be whole.
class CameraRays {
  public:
    CameraRays(const Camera& camera, glm::vec2 size)
        : view_(camera.view), clip_to_world_(glm::inverse(camera.projection * camera.view)), size_(size) {}

    // pixel: from the lower left corner of the frame; (1/2, 1/2) is the centre of the first one.
    Ray through(glm::vec2 pixel) const {
        const glm::vec2 ndc = 2.0F * pixel / size_ - 1.0F;
        const glm::vec4 near = clip_to_world_ * glm::vec4(ndc, -1.0F, 1.0F);
        const glm::vec4 far = clip_to_world_ * glm::vec4(ndc, 1.0F, 1.0F);
        const glm::vec3 origin = glm::vec3(near) / near.w;
        return {origin, glm::normalize(glm::vec3(far) / far.w - origin)};
    }

    // Distance along the camera's axis.
    float depth(const glm::vec3& position) const { return -(view_ * glm::vec4(position, 1.0F)).z; }

  private:
    glm::mat4 view_;
    glm::mat4 clip_to_world_;
    glm::vec2 size_;
};

}  // namespace verglas
