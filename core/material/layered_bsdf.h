// SPDX-License-Identifier: GPL-3.0-or-later
// Models of a coated surface in closed form, for path tracing, in its own frame: n = +Z, and o, the direction
// to the viewer, above it.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "core/material/layered_surface.h"

namespace verglas {

// How coated surfaces are path traced.
enum class LayerModel {
    Recursive,       // from interface to interface: the truth
    Endf,            // extended normal distribution functions (Guo et al. 2015), one for each bounce
    WeidlichWilkie,  // light that stays collimated in the layer meets the base once (2007)
};

class LayeredBsdf {
  public:
    // model: not Recursive. layer: of the material, which must both outlive this. only: the one bounce whose
    // light there is, 0 for the reflection by the surface; else all.
    LayeredBsdf(LayerModel model, const Material& material, const LayeredSurface& layer, const glm::vec3& o,
                std::optional<int> only = {});

    struct Value {
        glm::vec3 f_cos{0.0F};  // f(o, i) |i.n|
        float pdf = 0.0F;       // with which sample() draws i
    };
    Value evaluate(const glm::vec3& i) const;

    struct Sample {
        glm::vec3 direction;  // where the light comes from, above
        glm::vec3 weight;     // f |i.n| / pdf
        float pdf;            // per steradian
    };
    // None where a facet is masked. u: in [0, 1)^2 for the facet; choice: in [0, 1) for the bounce.
    std::optional<Sample> sample(glm::vec2 u, float choice) const;

    // The lobe that is drawn most, as a spherical Gaussian.
    RoughInterface::Lobe lobe() const;

  private:
    // Light that has met the base so often: none is the reflection by the surface.
    struct Bounce {
        glm::vec3 energy{0.0F};  // without the masking of i
        float kappa = 0.0F;      // of the surface's normals or the ENDF
        float probability = 0.0F;
    };

    const FacetNormals& normals() const { return layer_.outside().normals(); }
    const FacetNormals& base_normals() const { return layer_.base().normals(); }
    float fresnel(float cos_theta) const;  // of the surface, from outside
    bool is_shown(int bounce) const { return !only_ || *only_ == bounce; }
    void add_endf_bounces();
    void add_base_bounce();
    glm::vec3 base_value(const glm::vec3& i, float& pdf) const;
    std::optional<glm::vec3> sample_base(glm::vec2 u) const;

    const Material& material_;
    const LayeredSurface& layer_;
    bool is_endf_;  // else the base is met as Weidlich and Wilkie have it, as a diffuse one always is
    float eta_;
    glm::vec3 o_;
    glm::vec3 t_;        // o, refracted, and turned so that it shows up from the base
    float facing_area_;  // of the surface's facets, toward o
    std::array<Bounce, Layer::max_bounces + 1> bounces_;
    int count_ = 1;
    std::optional<int> only_;
};

}  // namespace verglas
