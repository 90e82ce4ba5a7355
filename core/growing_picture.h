// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "core/frame.h"
#include "core/scene/scene.h"
#include "core/scene/settings.h"

namespace verglas {

// Called with (samples done, all) on the calling thread; false ends the render.
using Progress = std::function<bool(int, int)>;

// A picture that can be looked at before it has all its samples. With n of them it is the one that a render
// of n samples gives. Pictures of one device wait for each other.
class GrowingPicture {
  public:
    virtual ~GrowingPicture() = default;

    // Starts anew; memory of the picture before serves again. Settings::samples are the most that it can grow
    // to. Throws Error for what can't be rendered.
    virtual void begin(Scene scene, const Settings& settings) = 0;

    // Grows to so many samples, at least one. False where progress ended that; it must then begin anew.
    // Throws Error.
    virtual bool grow(int samples, const Progress& progress) = 0;

    // What has grown; nothing where progress ended that. Throws Error.
    virtual std::optional<Frame> frame(const Progress& progress) = 0;
};

}  // namespace verglas
