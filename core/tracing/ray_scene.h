// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/scene/scene.h"

struct RTCDeviceTy;
struct RTCSceneTy;

namespace verglas {

// Where a ray meets a surface.
struct Hit {
    float t = 0.0F;
    glm::vec3 position{0.0F};
    glm::vec3 geometric_normal{0.0F};  // unit, outward by the triangle's winding
    glm::vec3 normal{0.0F};            // unit, interpolated
    glm::vec2 uv{0.0F};                // 0 where the mesh has none
    int material = 0;
    int object = 0;  // index into Scene::objects
};

// A scene for rays: one tree for each mesh, and one over all objects (Embree). Can be asked by many threads.
class RayScene {
  public:
    explicit RayScene(const Scene& scene);

    // The nearest surface beyond t = 0; d is a unit vector.
    std::optional<Hit> intersect(const glm::vec3& origin, const glm::vec3& d) const;
    // Whether nothing lies on the way to infinity.
    bool escapes(const glm::vec3& origin, const glm::vec3& d) const;

  private:
    struct Release {
        void operator()(RTCDeviceTy* device) const;
        void operator()(RTCSceneTy* scene) const;
    };
    using ScenePointer = std::unique_ptr<RTCSceneTy, Release>;

    struct Placed {
        std::shared_ptr<const Mesh> mesh;
        glm::mat4 matrix;
        glm::mat3 normal_matrix;  // object -> world, for normals
        std::vector<int> materials;
        int index;  // in Scene::objects
    };

    int material_of(const Placed& object, std::uint32_t triangle) const;

    std::unique_ptr<RTCDeviceTy, Release> device_;
    std::vector<ScenePointer> meshes_;
    ScenePointer top_;
    std::vector<Placed> objects_;  // by instance id
};

}  // namespace verglas
