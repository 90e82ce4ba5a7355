// SPDX-License-Identifier: GPL-3.0-or-later
// The sum of all samples of a traced picture. The first sample has no noise, but its lobes are an
// approximation; drawn samples are exact in the mean, but noisy. What they find the first to be wrong by is
// averaged, and as much of that is believed as stands out from its noise (empirical Bayes: James and Stein
// 1961), for a window of pixels as a whole, for small ones in it and for each pixel by itself. So error falls
// from the first drawn sample on, and the picture converges to the mean of drawn samples.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/frame.h"
#include "core/math/unfilled.h"
#include "core/scene/settings.h"
#include "core/tracing/bundle_tracer.h"

namespace verglas {

// Every step is taken for all parts of its rectangle before the next begins, in the order below; by many
// threads at once for parts that don't overlap.
class ProgressivePicture {
  public:
    // rect: the pixels wanted. Around them, first and drawn samples need margins, as far as the frame has
    // them.
    // Memory of the picture before serves again.
    void begin(const Rect& rect, const Settings& settings);
    const Rect& rect() const { return rect_; }
    const Rect& first_rect() const { return first_.rect; }
    const Rect& drawn_rect() const { return drawn_rect_; }

    // The first sample, over first_rect(): is traced into this, and then averaged over surfaces.
    TracedPicture& first() { return first_; }
    void average(const Rect& tile);

    const Unfilled<glm::vec3>& averaged() const { return averaged_; }

    // As long as it is the only one: fills a frame that has the pixels of rect(). Looks through edges of
    // objects, which are then smooth; tracer: of this sample.
    void resolve_first(const Rect& tile, const BundleTracer& tracer, Frame& frame) const;

    // Else: what drawn samples are compared with, over drawn_rect(); edges are smooth in it, too.
    void prepare(const Rect& tile, const BundleTracer& tracer);

    // Drawn sample `sample`, from 1 in a row, over drawn_rect().
    void add(const Rect& tile, const TracedPicture& drawn, int sample);

    // After that, over rect(): fills such a frame. More samples can be added afterwards.
    void set_samples(int samples) { drawn_samples_ = static_cast<float>(samples - 1); }
    void resolve(const Rect& tile, Frame& frame) const;

  private:
    // What is known of a pixel of drawn_rect().
    struct Pixel {
        glm::vec3 base;   // sum over looks: what the first sample shows there; or that under the filter
        float covered;    // sum over looks, of coverage
        int looks;        // 0: inside of an object
        int looks_ahead;  // drawn samples that base knows of from the start
        int object;       // which the pixel shows, or whose edge it sees
        glm::vec3 error;  // sum over drawn samples: what they see more than the first
        float square;     // sum of the squares of its mean over channels

        float mean_covered() const { return looks > 0 ? covered / static_cast<float>(looks) : covered; }
    };
    struct Estimate;
    struct Window;
    template <typename Value>
    struct Raster;

    const Surface& surface(glm::ivec2 pixel) const { return first_.surfaces[first_.place(pixel.x, pixel.y)]; }
    const glm::vec3& shown(glm::ivec2 pixel) const { return averaged_[first_.place(pixel.x, pixel.y)]; }
    const Pixel& known(glm::ivec2 pixel) const { return pixels_[drawn_rect_.place(pixel)]; }
    glm::vec3 seen(glm::vec2 place, int object, const glm::vec3& otherwise) const;
    bool is_edge(glm::ivec2 pixel) const;
    bool has_edge(const Rect& part) const;
    void look_through(glm::ivec2 pixel, const BundleTracer& tracer, Pixel& result) const;
    glm::vec3 base(glm::ivec2 pixel) const;
    glm::vec3 filtered(glm::ivec2 pixel) const;
    Estimate estimate(glm::ivec2 pixel) const;
    Window window(glm::ivec2 pixel, const Raster<Estimate>& estimates) const;
    Window surroundings(glm::ivec2 pixel, const Raster<Window>& windows) const;
    glm::vec3 corrected(glm::ivec2 pixel, const Raster<Estimate>& estimates,
                        const Raster<Window>& windows) const;
    void resolve_pixel(glm::ivec2 pixel, const glm::vec3& radiance, float covered, Frame& frame) const;

    Settings settings_;
    Rect rect_;
    Rect drawn_rect_;
    int reach_ = 0;  // of the pixel filter
    TracedPicture first_;
    Unfilled<glm::vec3> averaged_;  // radiance, in the order of first_
    std::vector<float> kernel_;     // of offsets -reach … reach, in whole pixels, along one axis
    Unfilled<Pixel> pixels_;
    float drawn_samples_ = 0.0F;
};

}  // namespace verglas
