// SPDX-License-Identifier: GPL-3.0-or-later
// The sum of all samples of a traced picture. The first sample has no noise, but its lobes are an
// approximation; drawn samples are exact in the mean, but noisy. What they find the first to be wrong by is
// averaged, and as much of that is believed as stands out from its noise (empirical Bayes: James and Stein
// 1961), for a small window of pixels as a whole and for each pixel by itself. So error falls from the first
// drawn sample on, and the picture converges to the mean of drawn samples.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/scene/settings.h"
#include "core/tracing/bundle_tracer.h"

namespace verglas {

class ProgressivePicture {
  public:
    // rect: the pixels wanted. Around them, first and drawn samples need margins, as far as the frame has
    // them. settings must outlive the picture.
    ProgressivePicture(const Rect& rect, const Settings& settings);
    Rect first_rect() const;
    Rect drawn_rect() const { return drawn_rect_; }

    // The first sample, over first_rect(), averaged over surfaces; tracer: which made it. Looks through edges
    // of objects, which are then smooth after few samples.
    void begin(TracedPicture first, const BundleTracer& tracer);

    // A drawn sample, over drawn_rect(), from 1 in a row.
    void add(const TracedPicture& drawn);

    // Of the pixels wanted, row 0 at the bottom: radiance, and coverage where the film is transparent,
    // else 1.
    std::vector<glm::vec4> resolve() const;

    // Of the same, through the pixels' centres; as Frame::normal_depth.
    std::vector<glm::vec4> normal_depth() const;

  private:
    // What is known of a pixel of drawn_rect().
    struct Pixel {
        glm::vec3 base{0.0F};   // sum over looks: what the first sample shows there; or that in the mean
        float covered = 0.0F;   // the same, of coverage
        int looks = 0;          // 0: base is a mean
        int object = -1;        // which the pixel shows, or whose edge it sees
        glm::vec3 error{0.0F};  // sum over drawn samples: what they see more than the first
        float square = 0.0F;    // sum of the squares of its mean over channels
    };
    // A Pixel as resolve() uses it: in units of the brightness around it.
    struct Estimate;

    glm::vec3 seen(glm::vec2 place, int object, const glm::vec3& otherwise) const;
    bool is_edge(glm::ivec2 pixel) const;
    void look_through(glm::ivec2 pixel, const BundleTracer& tracer, Pixel& result) const;
    glm::vec3 filtered(glm::ivec2 pixel) const;
    std::vector<Estimate> estimates() const;
    glm::vec3 corrected(glm::ivec2 pixel, const std::vector<Estimate>& estimates) const;
    std::size_t place(glm::ivec2 pixel) const;

    const Settings& settings_;
    Rect rect_;
    Rect drawn_rect_;
    TracedPicture first_;
    std::vector<float> kernel_;  // of offsets -reach … reach, in whole pixels, along one axis
    std::vector<Pixel> pixels_;
    int drawn_ = 0;
};

}  // namespace verglas
