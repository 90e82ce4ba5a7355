// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/scene/scene.h"
#include "core/tracing/divergence.h"

struct RTCDeviceTy;
struct RTCGeometryTy;
struct RTCSceneTy;

namespace verglas {

struct Ray {
    glm::vec3 origin;
    glm::vec3 d;  // unit
};

// Where a ray meets a surface.
struct Hit {
    float t = 0.0F;
    glm::vec3 position{0.0F};
    glm::vec3 geometric_normal{0.0F};  // unit, outward by the triangle's winding
    glm::vec3 normal{0.0F};            // unit, interpolated and bent by the material's relief
    glm::vec2 uv{0.0F};                // 0 where the mesh has none
    int material = 0;
    int object = 0;              // index into Scene::objects
    std::uint32_t instance = 0;  // of RayScene
    std::uint32_t triangle = 0;  // of the mesh

    // What a ray gets that meets nothing.
    static Hit none() {
        Hit hit;
        hit.t = std::numeric_limits<float>::infinity();
        hit.material = hit.object = -1;
        return hit;
    }
};

// A scene for rays: one tree for each mesh, and one over all objects (Embree). Can be asked by many threads,
// but not while update() runs.
class RayScene {
  public:
    // Empty. Throws Error where Embree can't be started.
    RayScene();
    // The same, and update(scene).
    explicit RayScene(const Scene& scene);

    // Follows the scene and builds only what has changed. A mesh is known again by its identity; one of the
    // same name and triangles as another that has gone takes over its tree, which is refit to the new
    // positions as long as that pays. Objects that are scaled to nothing aren't there. Throws Error where
    // memory doesn't suffice.
    void update(const Scene& scene);

    // The nearest surface beyond t = 0. Rays with values that aren't finite, or come from farther away than
    // 1e8, meet nothing.
    std::optional<Hit> intersect(const glm::vec3& origin, const glm::vec3& d) const;
    // The same of many rays; Hit::none() where nothing is met. hits: as many as rays. Neighbours should go
    // similar ways: the same ray of eight pixels' bundles one after the other, not the four of each pixel.
    void intersect(std::span<const Ray> rays, std::span<Hit> hits) const;
    // Of the surface that the interpolated normal stands for. 0 where triangles are flat or too thin to tell.
    Curvature curvature(const Hit& hit) const { return objects_[hit.instance].curvature(hit.triangle); }
    // Whether nothing lies on the way up to this distance.
    bool escapes(const glm::vec3& origin, const glm::vec3& d,
                 float distance = std::numeric_limits<float>::infinity()) const;

  private:
    struct Release {
        void operator()(RTCDeviceTy* device) const;
        void operator()(RTCGeometryTy* geometry) const;
        void operator()(RTCSceneTy* scene) const;
    };
    using GeometryPointer = std::unique_ptr<RTCGeometryTy, Release>;
    using ScenePointer = std::unique_ptr<RTCSceneTy, Release>;

    // Of one mesh.
    struct Tree {
        std::shared_ptr<const Mesh> mesh;
        std::shared_ptr<const Mesh> built;  // what the tree was built for; lends Embree its indices
        ScenePointer scene;
        GeometryPointer geometry;  // the scene's only one
    };

    struct Placed {
        std::shared_ptr<const Mesh> mesh;
        RTCSceneTy* tree;
        glm::mat4 matrix;
        glm::mat3 normal_matrix;  // object -> world, for normals
        std::vector<int> materials;
        int index;               // in Scene::objects
        std::uint32_t instance;  // in objects_

        Hit hit(float t, std::uint32_t triangle, float u, float v, const glm::vec3& outward) const;
        Curvature curvature(std::uint32_t triangle) const;
        glm::vec3 bent_normal(const glm::vec3& n, const Relief& relief, std::uint32_t triangle, float u,
                              float v) const;
        int material_of(std::uint32_t triangle) const;
        int material_of(const MeshPart& part) const;
    };

    Hit hit(unsigned instance, const glm::vec3& d, float t, std::uint32_t triangle, float u, float v,
            const glm::vec3& outward) const;
    bool update_trees(const Scene& scene);
    void build(Tree& tree) const;
    void deform(Tree& tree) const;
    void build_top();
    template <int width>
    void intersect_packets(std::span<const Ray> rays, std::span<Hit> hits) const;

    std::atomic<int> error_{0};  // Embree's last; outlives the device
    std::unique_ptr<RTCDeviceTy, Release> device_;
    int packet_width_ = 0;
    std::vector<Tree> trees_;
    ScenePointer top_;
    std::vector<Placed> objects_;  // by instance id
    std::vector<Relief> reliefs_;  // by material; empty where none has any
};

}  // namespace verglas
