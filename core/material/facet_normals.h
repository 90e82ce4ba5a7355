// SPDX-License-Identifier: GPL-3.0-or-later
// How the normals m of a rough interface's microfacets are distributed about its own normal n = +Z, and what
// of them is seen from a direction o above it.
#pragma once

#include <glm/glm.hpp>

#include "core/material/lobe_tables.h"
#include "core/math/von_mises_fisher.h"

namespace verglas {

class FacetNormals {
  public:
    // The heightfields of Walter et al. 2007; alpha > 0.
    FacetNormals(Ndf ndf, float alpha) : FacetNormals(static_cast<Kind>(ndf), alpha) {}
    // vMF normals D(m) = M(m; n, kappa) / A3(kappa) with kappa = 2 / alpha^2 (the ENDF paper, eq. 6), alpha
    // up to max_vmf_alpha. They are of a surface with overhangs: some look down, for all of the sphere.
    static FacetNormals von_mises_fisher(float alpha);
    static constexpr float max_vmf_alpha = 1.41421356F;  // kappa = 1

    // Per steradian; D(m) (m.n) integrates to 1.
    float density(float cos_theta_m) const;

    // Draws a normal, by those that o sees where that has a closed form. u: in [0, 1)^2. It may face away
    // from o.
    glm::vec3 sample(const glm::vec3& o, glm::vec2 u) const;
    // Its density.
    float pdf(const glm::vec3& o, const glm::vec3& m) const;

    // G1: the share of the facets toward a direction that is not hidden by others.
    float masking(float cos_theta) const;
    // G(o, i) |o.m| D(m) / (|o.n| pdf(m)): what a sample of light from i weighs, but for Fresnel's factor.
    float weight(const glm::vec3& o, const glm::vec3& m, const glm::vec3& i) const;

    // Concentration of about such a vMF distribution.
    float kappa() const { return vmf_.kappa(); }

  private:
    enum class Kind {
        Beckmann = model::NDF_BECKMANN,
        Ggx = model::NDF_GGX,
        BlinnPhong = model::NDF_BLINN_PHONG,
        VonMisesFisher,
    };
    FacetNormals(Kind kind, float alpha) : kind_(kind), alpha_(alpha), vmf_(2.0F / (alpha * alpha)) {}

    Kind kind_;
    float alpha_;
    VonMisesFisher vmf_;
};

// The integral of <o,m> M(m; n, kappa) over all directions m, at o.n = cos_theta >= 0: the area of vMF facets
// that look toward o, without masking (the ENDF paper approximates it by eq. 8). For kappa >= 1; relative
// error below 1e-3.
float vmf_facing_area(float kappa, float cos_theta);

}  // namespace verglas
