// SPDX-License-Identifier: GPL-3.0-or-later
// How far the light that a ray stands for spreads about it: the variances of directions and of positions
// across its way and their covariance, to first order in both and in the mean over both axes (covariance
// tracing: Belcour et al. 2013). Curved surfaces turn what has spread in position apart, so that lobes that
// bounce inside glass widen far beyond what roughness does to them.
#pragma once

#include <algorithm>
#include <cmath>

namespace verglas {

// Of a surface where it is hit; its principal curvatures are mean + deviation and mean - deviation. 1 /
// radius, positive where it bulges to the side that normals show to.
struct Curvature {
    float mean = 0.0F;
    float deviation = 0.0F;
};

class Divergence {
  public:
    // Of a single ray.
    Divergence() = default;
    // Of a lobe that begins in a point. spread: its 1 - R, 0 … 1. Lengths R of lobes one after the other
    // multiply, so that variances, as -log(R), add.
    static Divergence of_lobe(float spread) {
        constexpr float most_spread = 0.9999F;
        return Divergence(-std::log1p(-std::min(spread, most_spread)));
    }

    bool is_none() const { return angular_ <= 0.0F; }

    // 1 - R of the directions, 0 … most_spread: none is wider than the half space that an interface sends
    // light to.
    float spread() const { return std::min(-std::expm1(-angular_), half_space_spread); }

    // The same with a lobe of that spread, which it would be after widen(), sooner.
    float spread_with(float lobe_spread) const {
        const float own = is_none() ? 0.0F : -std::expm1(-angular_);
        return std::min(own + (1.0F - own) * lobe_spread, half_space_spread);
    }

    // Over a distance, in world units.
    void travel(float t) {
        positional_ += t * (2.0F * mixed_ + t * angular_);
        mixed_ += t * angular_;
    }

    // At an interface, which turns directions scale times as far, and by bend times the tilt of its normal.
    void turn(float scale, float bend, const Curvature& curvature) {
        const float by_position = bend * curvature.mean;
        const float square =
            bend * bend * (curvature.mean * curvature.mean + curvature.deviation * curvature.deviation);
        angular_ = scale * (scale * angular_ + 2.0F * by_position * mixed_) + square * positional_;
        angular_ = std::max(angular_, 0.0F);  // which rounding may miss
        mixed_ = scale * mixed_ + by_position * positional_;
        if (!(angular_ < all_directions)) *this = Divergence(all_directions);
    }

    // A part of all variances, 0 … 1.
    Divergence part(float share) const {
        Divergence result = *this;
        result.angular_ *= share;
        result.mixed_ *= share;
        result.positional_ *= share;
        return result;
    }

    // By what an interface's own lobe spreads.
    void widen(const Divergence& lobe) { angular_ += lobe.angular_; }

  private:
    static constexpr float half_space_spread = 0.5F;
    // Beyond it nothing is left of where the light came from.
    static constexpr float all_directions = 4.0F;

    explicit Divergence(float angular) : angular_(angular) {}

    float angular_ = 0.0F;
    float mixed_ = 0.0F;
    float positional_ = 0.0F;
};

}  // namespace verglas
