// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>

namespace verglas {

// The von Mises-Fisher distribution of unit directions about +Z with concentration kappa > 0: a normalised
// spherical Gaussian. What depends on kappa alone is computed once.
class VonMisesFisher {
  public:
    explicit VonMisesFisher(float kappa)
        : kappa_(kappa),
          normalisation_(1.0F - (kappa < 20.0F ? std::exp(-2.0F * kappa) : 0.0F)),  // else it is below 1e-17
          peak_(kappa / (2.0F * glm::pi<float>() * normalisation_)) {}

    float kappa() const { return kappa_; }

    // Per steradian, at this cosine to the axis.
    float density(float cosine) const {
        const float exponent = kappa_ * (cosine - 1.0F);
        return exponent > -80.0F ? peak_ * std::exp(exponent) : 0.0F;  // what underflows takes long
    }

    // u: in [0, 1)^2.
    glm::vec3 sample(glm::vec2 u) const {
        // Inverse of the distribution of 1 - cos theta, which keeps its precision for narrow ones.
        const float versine = std::min(-std::log1p(-u.x * normalisation_) / kappa_, 2.0F);
        const float sine = std::sqrt(versine * (2.0F - versine));
        const float phi = 2.0F * glm::pi<float>() * u.y;
        return {sine * std::cos(phi), sine * std::sin(phi), 1.0F - versine};
    }

  private:
    float kappa_;
    float normalisation_;  // 1 - exp(-2 kappa)
    float peak_;
};

}  // namespace verglas
