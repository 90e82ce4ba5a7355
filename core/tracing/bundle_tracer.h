// SPDX-License-Identifier: GPL-3.0-or-later
// Traced bundles (method: 5.5): the four rays that stand for the front lobe of a pixel are followed from
// interface to interface, each along the mean directions of the lobes that it meets, and end in the
// prefiltered environment. No chance is involved, so there is no noise.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/scene/settings.h"
#include "core/tracing/camera_rays.h"
#include "core/tracing/traced_scene.h"

namespace verglas {

// What the centre of a pixel shows.
struct Surface {
    glm::vec3 normal{0.0F};  // unit, world space, outward
    float depth = 1e10F;     // along the camera's axis; 1e10 where nothing is
    int object = -1;         // -1 where nothing is
    float alpha = 0.0F;      // width of the distribution of microfacet normals
};

// A picture of a region of the frame, row 0 at the bottom.
struct TracedPicture {
    explicit TracedPicture(const Rect& rectangle)
        : rect(rectangle), radiance(std::size_t(rect.size().x) * rect.size().y), surfaces(radiance.size()) {}

    std::size_t place(int x, int y) const {
        return std::size_t(y - rect.begin.y) * rect.size().x + (x - rect.begin.x);
    }

    Rect rect;
    std::vector<glm::vec3> radiance;
    std::vector<Surface> surfaces;
};

class BundleTracer {
  public:
    // Both must outlive it.
    BundleTracer(const TracedScene& scene, const Settings& settings);

    // Fills a part of the picture, which must lie within its region. By many threads at once.
    void trace(const Rect& tile, TracedPicture& picture) const;

  private:
    struct Beam;
    struct Branch;
    struct Wave;

    void start(const Rect& tile, const TracedPicture& picture, Wave& wave) const;
    void meet(const Beam& beam, const Ray& ray, const Hit& hit, TracedPicture& picture, Wave& next) const;
    void follow(const Beam& beam, const Hit& hit, const glm::vec3& n, const Branch& branch, Wave& next) const;
    void split_front(const Beam& beam, const Hit& hit, const glm::vec3& n, const Branch& branch,
                     Wave& next) const;
    glm::vec3 cut_off(const Beam& beam, const Branch& branch) const;

    const TracedScene& scene_;
    const Settings& settings_;
    CameraRays camera_;
};

}  // namespace verglas
