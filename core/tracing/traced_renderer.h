// SPDX-License-Identifier: GPL-3.0-or-later
// The CPU device: scene in, frame out, as Renderer, without OpenGL.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "core/growing_picture.h"

namespace verglas {

// Traces bundles of rays through the scene (method: 5.5) and keeps what is costly to prepare: trees of
// meshes, lobe tables, the environment's levels.
//
// The first sample is a picture without noise: a few rays stand for the front lobe, follow the mean
// directions of all lobes that they meet, and end in the prefiltered environment. Further samples draw
// directions, and the picture converges to the path tracer's. It depends on scene and settings alone, not on
// the number of threads.
class TracedRenderer {
  public:
    // Throws Error where Embree can't be started.
    TracedRenderer();
    ~TracedRenderer();

    // Waits for the picture, and before that for those that other threads have asked for; nothing when
    // progress, which is called at least every few dozen milliseconds, ended it. Throws Error.
    std::optional<Frame> render(const Scene& scene, const Settings& settings, const Progress& progress = {});

    // Grows by the same device; may outlive the renderer.
    std::unique_ptr<GrowingPicture> make_picture();

  private:
    class Device;
    class Picture;
    std::shared_ptr<Device> device_;
    std::unique_ptr<Picture> picture_;  // of render()
    std::mutex rendering_;
};

}  // namespace verglas
