// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/frame.h"
#include "core/tracing/bundle_tracer.h"

namespace verglas {

// A first sample of squares of pixels, shown to all pixels: smooth inside of objects, and with outlines as
// sharp as the pixels, for which rays look where squares that are neighbours show different objects.
class UpscaledPicture {
  public:
    // rect: pixels of the frame that are wanted. first, radiance (in its order) and tracer: of the squares
    // that hold them. All must outlive it.
    UpscaledPicture(const Rect& rect, const Settings& settings, const TracedPicture& first,
                    const Unfilled<glm::vec3>& radiance, const BundleTracer& tracer)
        : rect_(rect), settings_(settings), first_(first), radiance_(radiance), tracer_(tracer) {}

    // Fills a part of a frame that has the pixels of rect.
    void resolve(const Rect& tile, Frame& frame) const;

  private:
    void set(glm::ivec2 pixel, const glm::vec3& radiance, const Surface& surface, Frame& frame) const;
    void look(std::span<const glm::ivec2> pixels, Frame& frame) const;
    void set_edge(glm::ivec2 pixel, const BundleTracer::Sight& sight, Frame& frame) const;

    Rect rect_;
    const Settings& settings_;
    const TracedPicture& first_;
    const Unfilled<glm::vec3>& radiance_;
    const BundleTracer& tracer_;
};

}  // namespace verglas
