// SPDX-License-Identifier: GPL-3.0-or-later
// Traced bundles (method: 5.5): the rays that stand for the front lobe of a pixel are followed from interface
// to interface, each along the mean directions of the lobes that it meets, and end in the prefiltered
// environment. No chance is involved, so there is no noise. Further samples draw four rays from the
// microfacets of the front, and all later directions, and only the last lobe is still looked up.
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

// Where sample `sample` of a pixel looks through the frame, from the pixel's centre, in pixels: distributed
// like the pixel filter; the first sample looks through the centre.
glm::vec2 sample_offset(glm::ivec2 pixel, int sample, const Settings& settings);

class BundleTracer {
  public:
    // Both must outlive it. sample: 0 is the picture without noise; further ones are drawn, each of them new,
    // and their mean converges to what a path tracer finds.
    BundleTracer(const TracedScene& scene, const Settings& settings, int sample);

    // Fills a part of the picture, which must lie within its region. By many threads at once.
    void trace(const Rect& tile, TracedPicture& picture) const;

    // What the camera sees through a place of the frame, in pixels from its lower left corner.
    struct Sight {
        int object;            // -1 where nothing is
        glm::vec3 background;  // where nothing is
    };
    Sight look(glm::vec2 place) const;

  private:
    struct Beam;
    struct Meeting;
    struct Branch;
    struct Wave;

    void start(const Rect& tile, Wave& wave) const;
    void meet(const Beam& incoming, const Hit& hit, TracedPicture& picture, Wave& next) const;
    void branch_off(const Meeting& meeting, const Branch& branch, bool is_greater, Wave& next) const;
    void follow(const Meeting& meeting, const Branch& branch, Wave& next) const;
    void split(const Meeting& meeting, const Branch& branch, Wave& next) const;
    void draw(const Meeting& meeting, const Branch& branch, Wave& next) const;
    void draw_ray(const Meeting& meeting, const Branch& branch, float share, Beam outgoing, Wave& next) const;
    void send(const Meeting& meeting, const Branch& branch, Beam outgoing, Wave& next) const;
    glm::vec3 background(const glm::vec3& d) const;
    glm::vec3 looked_up(const Beam& beam) const;
    glm::vec3 cut_off(const Meeting& meeting, const Branch& branch) const;

    const TracedScene& scene_;
    const Settings& settings_;
    CameraRays camera_;
    int sample_;
};

}  // namespace verglas
