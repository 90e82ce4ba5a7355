// SPDX-License-Identifier: GPL-3.0-or-later
// The CPU device: scene in, frame out, as Renderer, without OpenGL.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "core/frame.h"
#include "core/scene/scene.h"
#include "core/scene/settings.h"

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

    // Called with (samples done, all) on the calling thread, at least every few dozen milliseconds; false
    // ends the render.
    using Progress = std::function<bool(int, int)>;

    // Waits for the picture, and before that for those that other threads have asked for; nothing when
    // progress ended it. Throws Error.
    std::optional<Frame> render(const Scene& scene, const Settings& settings, const Progress& progress = {});

  private:
    class Device;
    std::unique_ptr<Device> device_;
};

}  // namespace verglas
