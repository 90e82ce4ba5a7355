// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth: a path tracer of the same scene and material model (Walter et al. 2007).
#pragma once

#include <functional>
#include <optional>

#include "core/frame.h"
#include "core/scene/scene.h"
#include "core/scene/settings.h"

namespace verglas {

enum class PathMode {
    TwoInterface,  // enter, leave, and straight into the environment: what the paper compares with
    Full,          // reflection, inner reflections, re-entry
};

struct PathSettings {
    glm::ivec2 size{512};
    int samples = 64;
    float filter_width = 1.5F;
    PathMode mode = PathMode::Full;
    bool transparent = false;
    int max_interfaces = 64;  // longer paths end
    std::uint64_t seed = 0;
};

// Renders with all cores; the picture depends on the scene, the settings and nothing else. progress is called
// with (done, all) after each pass of one sample a pixel; false ends the render. Throws Error.
std::optional<Frame> trace_paths(const Scene& scene, const PathSettings& settings,
                                 const std::function<bool(int, int)>& progress = {});

}  // namespace verglas
