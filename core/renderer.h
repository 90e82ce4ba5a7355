// SPDX-License-Identifier: GPL-3.0-or-later
// Scene in, frame out.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "core/frame.h"
#include "core/gl/thread.h"
#include "core/scene/scene.h"
#include "core/scene/settings.h"

namespace verglas {

// Owns the GL thread and what has been uploaded.
class Renderer {
  public:
    // Throws Error where EGL or OpenGL 4.5 is missing.
    Renderer();
    ~Renderer();

    const std::string& device() const { return thread_.device(); }

    // Called after each sample with (done, all) on the calling thread; false ends the render.
    using Progress = std::function<bool(int, int)>;

    // Waits for the picture, and before that for those that other threads have asked for; nothing when
    // progress ended it. Throws Error.
    std::optional<Frame> render(const Scene& scene, const Settings& settings, const Progress& progress = {});

  private:
    class Device;  // what lives on the GL thread

    gl::Thread thread_;
    std::unique_ptr<Device> device_;
    std::mutex rendering_;
};

}  // namespace verglas
