// SPDX-License-Identifier: GPL-3.0-or-later
// A pane or a coating as interfaces that light meets one after the other: what recursive sampling needs. In
// the frame of its near side, where the viewer is: n = +Z, and o, a direction toward the viewer, above it.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "core/material/microfacet.h"
#include "core/scene/scene.h"

namespace verglas {

// Of a side of a material: coatings have vMF normals, whatever Material::ndf says.
FacetNormals normals_of(const Material& material, float alpha);

// The opaque base under a coating: a rough conductor with vMF normals, or Lambert's diffuse one.
class CoatingBase {
  public:
    CoatingBase(const Layer& layer, float alpha)
        : layer_(layer), normals_(FacetNormals::von_mises_fisher(alpha)) {}

    struct Sample {
        glm::vec3 direction;  // where the light comes from, above the base
        glm::vec3 weight;     // f |i.n| / pdf
    };
    // None where a facet is masked. u: in [0, 1)^2.
    std::optional<Sample> sample(const glm::vec3& o, glm::vec2 u) const;

    struct Value {
        glm::vec3 f_cos{0.0F};  // f(o, i) |i.n|
        float pdf = 0.0F;       // with which sample() draws i
    };
    Value evaluate(const glm::vec3& o, const glm::vec3& i) const;

    // Of a facet of the conductor: Schlick's reflectance, lowered so that at 82 degrees, where the cosine is
    // 1/7, it is edge_tint times his (Kutz, Hasan and Edmondson 2021).
    glm::vec3 fresnel(float cos_theta) const;

    const FacetNormals& normals() const { return normals_; }

  private:
    const Layer& layer_;
    FacetNormals normals_;
};

class LayeredSurface {
  public:
    // entering: whether the viewer is on the side that the mesh's normal shows to. alpha, layer_alpha: of the
    // material's roughness and its layer's. material must outlive this.
    LayeredSurface(const Material& material, bool entering, float alpha, float layer_alpha);

    // The near side, from the viewer's and from within.
    const RoughInterface& outside() const { return outside_; }
    const RoughInterface& near() const { return near_; }
    // The other side of a pane, from within; none of a coating, which has its base there.
    const std::optional<RoughInterface>& far() const { return far_; }
    const CoatingBase& base() const { return base_; }
    // Of the layer to its surroundings.
    float eta() const { return eta_; }

    // The share of light that is left after one crossing of a coating (Beer-Lambert); all of it in a pane.
    glm::vec3 transmittance(float cos_theta) const;

  private:
    LayeredSurface(const Material& material, const FacetNormals& near, const FacetNormals& far,
                   float base_alpha);

    float eta_;
    RoughInterface outside_;
    RoughInterface near_;
    std::optional<RoughInterface> far_;
    CoatingBase base_;
    glm::vec3 optical_depth_{0.0F};  // straight through
};

}  // namespace verglas
