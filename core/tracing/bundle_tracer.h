// SPDX-License-Identifier: GPL-3.0-or-later
// Traced bundles (method: 5.5): the rays that stand for the front lobe of a pixel are followed from interface
// to interface, each along the mean directions of the lobes that it meets, and end in the prefiltered
// environment. No chance is involved, so there is no noise. Further samples draw four rays from the
// microfacets of the front, and all later directions, and only the last lobe is still looked up.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "core/material/pane_walk.h"
#include "core/math/sobol.h"
#include "core/math/unfilled.h"
#include "core/scene/settings.h"
#include "core/tracing/camera_rays.h"
#include "core/tracing/divergence.h"
#include "core/tracing/layer_lobes.h"
#include "core/tracing/traced_scene.h"

namespace verglas {

// What a sample of a pixel shows.
struct Surface {
    glm::vec3 normal;  // unit, world space, outward; 0 where nothing is
    float depth;       // along the camera's axis; 1e10 where nothing is
    int object;        // -1 where nothing is
    float alpha;       // width of the distribution of microfacet normals

    static Surface none() { return {glm::vec3(0.0F), 1e10F, -1, 0.0F}; }
};

// A picture of a region of the frame, row 0 at the bottom.
struct TracedPicture {
    // Its pixels have no values then; who writes to a tile fills it best.
    void begin(const Rect& rectangle) {
        rect = rectangle;
        radiance.resize(rect.pixels());
        surfaces.resize(rect.pixels());
    }
    std::size_t place(int x, int y) const { return rect.place({x, y}); }

    Rect rect;
    Unfilled<glm::vec3> radiance;
    Unfilled<Surface> surfaces;
};

// Where sample `sample` of a pixel looks through the frame, from the pixel's centre, in pixels: distributed
// like the pixel filter; the first sample looks through the centre.
glm::vec2 sample_offset(glm::ivec2 pixel, int sample, const Settings& settings);

class BundleTracer {
  public:
    // Both must outlive it. Its pixels are Settings::pixel_size wide. sample: 0 is the picture without noise;
    // further ones are drawn, each of them new, and their mean converges to what a path tracer finds.
    BundleTracer(const TracedScene& scene, const Settings& settings, int sample);

    // Fills a part of the picture, which must lie within its region. By many threads at once.
    void trace(const Rect& tile, TracedPicture& picture) const;

    // What the camera sees through places of the frame, in pixels from its lower left corner.
    struct Sight {
        int object;            // -1 where nothing is
        glm::vec3 background;  // where nothing is; else 0
    };
    void look(std::span<const glm::vec2> places, std::span<Sight> sights) const;

  private:
    struct Beam;
    struct Meeting;
    struct Branch;
    enum class Way;
    struct Lookups;
    struct Wave;
    struct View;

    void see(View& view) const;
    void start(const Rect& tile, TracedPicture& picture, Wave& next) const;
    void meet(const Beam& incoming, const glm::vec3& d, const Hit& hit, TracedPicture& picture,
              Wave& next) const;
    void meet_layer(const Meeting& meeting, Wave& next) const;
    void branch_off(const Meeting& meeting, const Branch& branch, bool is_greater, Wave& next) const;
    bool is_followed(const Meeting& meeting, float weight, bool is_greater) const;
    void go_on(const Meeting& meeting, const Branch& branch, Wave& next) const;
    void light(const Meeting& meeting, const Branch& branch) const;
    float left_part(float roughness) const;
    Divergence turned(Divergence divergence, const Meeting& meeting, Way way) const;
    Divergence divergence(const Meeting& meeting, const Branch& branch) const;
    float spread_after(const Meeting& meeting, const Branch& branch) const;
    void follow(const Meeting& meeting, const Branch& branch, Wave& next) const;
    void split(const Meeting& meeting, const Branch& branch, Wave& next) const;
    void draw(const Meeting& meeting, const Branch& branch, Wave& next) const;
    void draw_ray(const Meeting& meeting, const Branch& branch, Beam outgoing, Wave& next) const;
    void look_between(const Meeting& meeting, const Branch& branch, const glm::vec3& d, Beam& outgoing) const;
    SobolPoint point_of(const Beam& beam) const;
    static Branch branch_of(const Meeting& meeting, const LayerLobe& lobe);
    void draw_mirrored(const Meeting& meeting, const LayerLobes& lobes, Wave& next) const;
    void draw_from_within(const Meeting& meeting, const LayerLobes& lobes, Wave& next) const;
    void draw_lobe(const Meeting& meeting, const Branch& branch, Beam outgoing, Wave& next) const;
    void draw_layer(const Meeting& meeting, Wave& next) const;
    void draw_front_reflection(const Meeting& meeting, Wave& next) const;
    void draw_walk(const Meeting& meeting, Beam outgoing, Wave& next) const;
    model::Lobe last_lobe(const Meeting& meeting, const PaneWalk& end, float roughness) const;
    void send(const Meeting& meeting, const Branch& branch, const glm::vec3& d, Wave& next) const;
    glm::vec3 looked_up(const Beam& beam) const;
    glm::vec3 looked_up(const Beam& beam, float spread) const;
    glm::vec3 looked_up(Lookups& lookups) const;
    glm::vec3 cut_off(const Meeting& meeting, const Branch& branch) const;

    const TracedScene& scene_;
    const Settings& settings_;
    CameraRays camera_;
    int sample_;
};

}  // namespace verglas
