// SPDX-License-Identifier: GPL-3.0-or-later
// The scattering of one rough interface, for path tracing (Walter et al. 2007), in its own frame: n = +Z, and
// o, the direction to the viewer, above it.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "core/material/facet_normals.h"

namespace verglas {

// What of the light that an interface reflects is followed.
enum class Reflected {
    None,
    Total,  // by facets beyond their critical angle
    All,
};

// A rough interface with relative index eta = n_behind / n_before.
class RoughInterface {
  public:
    // fresnel: whether 1 - F is refracted and F reflected; else all is refracted that can be, and only facets
    // beyond their critical angle reflect.
    RoughInterface(const FacetNormals& normals, float eta, bool fresnel, Reflected reflected)
        : normals_(normals), eta_(eta), fresnel_(fresnel), reflected_(reflected) {}
    RoughInterface(Ndf ndf, float alpha, float eta, bool fresnel, Reflected reflected)
        : RoughInterface(FacetNormals(ndf, alpha), eta, fresnel, reflected) {}

    struct Sample {
        glm::vec3 direction;  // where the light comes from: above when reflected, below when refracted
        float weight;         // f |i.n| / pdf
        float pdf;            // per steradian
    };
    // Draws a direction; none where a facet is masked or reflects totally what is only refracted. u: in [0,
    // 1)^2 for the facet; choice: in [0, 1) for reflection or refraction.
    std::optional<Sample> sample(const glm::vec3& o, glm::vec2 u, float choice) const;

    enum class Event { Refract, Reflect };
    // Draws a direction of one event: weight is then of that event alone, with its 1 - F or F, whatever
    // `reflected` says; pdf is left 0. None where a facet is masked or lets nothing through.
    std::optional<Sample> sample(const glm::vec3& o, glm::vec2 u, Event event) const;

    struct Value {
        float f_cos = 0.0F;  // f(o, i) |i.n|
        float pdf = 0.0F;    // with which sample() draws i
    };
    Value evaluate(const glm::vec3& o, const glm::vec3& i) const;

    // The lobe of light that is reflected or refracted toward o, as a spherical Gaussian.
    struct Lobe {
        glm::vec3 axis;  // where the light comes from: above when reflected, below when refracted
        float kappa;
    };
    Lobe lobe(const glm::vec3& o, bool reflected) const;

    const FacetNormals& normals() const { return normals_; }

    // The same, of which only refraction is followed.
    RoughInterface refracting() const { return {normals_, eta_, fresnel_, Reflected::None}; }

  private:
    std::optional<glm::vec3> direction(const glm::vec3& o, const glm::vec3& m, Event event) const;
    float fresnel(float o_m) const;
    float reflected_share(float o_m) const;

    FacetNormals normals_;
    float eta_;
    bool fresnel_;
    Reflected reflected_;
};

}  // namespace verglas
