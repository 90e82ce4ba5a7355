// SPDX-License-Identifier: GPL-3.0-or-later
// Scene in, frame out.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "core/gl/thread.h"
#include "core/growing_picture.h"

namespace verglas {

// Owns the GL thread and what has been uploaded.
class Renderer {
  public:
    // Throws Error where EGL or OpenGL 4.5 is missing.
    Renderer();
    ~Renderer();

    const std::string& device() const { return thread_.device(); }

    // Waits for the picture, and before that for those that other threads have asked for; nothing when
    // progress, which is called after each sample, ended it. Throws Error.
    std::optional<Frame> render(const Scene& scene, const Settings& settings, const Progress& progress = {});

    // Grows on the same GL thread; must not outlive the renderer.
    std::unique_ptr<GrowingPicture> make_picture();

  private:
    class Device;  // what lives on the GL thread
    struct Canvas;
    class Picture;

    gl::Thread thread_;
    std::unique_ptr<Device> device_;
    std::unique_ptr<Picture> picture_;  // of render()
    std::mutex picture_mutex_;
    std::mutex rendering_;
};

}  // namespace verglas
