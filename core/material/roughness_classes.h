// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "core/scene/texture.h"

namespace verglas {

// How the roughnesses of a texture are distributed over its area.
class RoughnessHistogram {
  public:
    explicit RoughnessHistogram(const Texture& texture);

    // 0 … 1.
    float mean() const { return mean_; }

    // Classes of roughness that stand for all of them, between which neighbours are interpolated linearly
    // (shaders/lib/coverage.glsl): ascending, 1 to `most` (>= 2), the least and the greatest roughness among
    // them. Those with the least mean error of such an interpolation, (x - a) (b - x) for x between a and b;
    // no more than it takes.
    std::vector<float> classes(int most) const;

  private:
    std::vector<double> roughness_;  // of the bins that hold any, ascending
    std::vector<double> weight_;     // their shares of the area
    float mean_ = 0.0F;
};

}  // namespace verglas
