// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth: a path tracer of the same scene and material model (Walter et al. 2007), with
// thin layers followed by recursive sampling from interface to interface, and connected to the light at each
// of their outer sides.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "core/material/layered_bsdf.h"
#include "core/scene/scene.h"
#include "core/scene/settings.h"

namespace verglas {

struct PathSettings {
    glm::ivec2 size{512};
    std::optional<Rect> region;  // the part that is rendered and returned
    float filter_width = 1.5F;
    PathMode mode = PathMode::Full;
    bool tir =
        false;  // TwoInterface: totally reflected light goes on inside until it leaves; else it is lost
    LayerModel layers = LayerModel::Recursive;  // of coated surfaces
    // Of light that they send on, only what has met the base so often; else all. Recursive sampling takes
    // all paths there, so that each costs as many interfaces.
    std::optional<int> bounce;
    bool transparent = false;
    int max_interfaces = 64;  // that bend light; longer paths end
    std::uint64_t seed = 0;
};

// A picture that gains precision with each sample. Samples are points of a Sobol sequence: numbers of them
// that are powers of two converge best. Uses all cores; the picture depends on the scene, the settings and
// the number of samples, and nothing else.
class PathTracer {
  public:
    // Throws Error where Embree can't be had or the settings make no picture.
    PathTracer(Scene scene, const PathSettings& settings);
    ~PathTracer();

    // Called with (done, all) on the calling thread, several times a second; false ends the render.
    using Progress = std::function<bool(int, int)>;

    // Adds samples to every pixel; false where progress ended it before all were done. Throws Error.
    bool render(int samples, const Progress& progress = {});

    // Whole samples of all pixels so far.
    int samples() const { return samples_; }

    // The mean of the samples so far; `seconds` is the time spent in render(). Throws Error before the first
    // sample.
    Frame frame() const;

  private:
    class Paths;  // what a path meets

    void trace_row(int row);

    const Scene scene_;
    const PathSettings settings_;
    const Rect rect_;
    std::unique_ptr<const Paths> paths_;
    std::vector<glm::vec4> sums_;
    std::vector<glm::vec4> normal_depth_;
    std::vector<int> row_samples_;  // of the region's rows, as sums_ is
    int samples_ = 0;
    double seconds_ = 0.0;
};

}  // namespace verglas
