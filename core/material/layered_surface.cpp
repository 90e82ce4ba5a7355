// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/layered_surface.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/material/model.h"

namespace verglas {
namespace {

constexpr float pi = glm::pi<float>();

// Of glass to its surroundings. Next to 1 an interface's lobes are too narrow for float, and reflect nothing.
float layer_index(float ior) {
    constexpr float least = 1.001F;
    const float eta = std::clamp(ior, 1.0F / max_eta, max_eta);
    return eta < 1.0F ? std::min(eta, 1.0F / least) : std::max(eta, least);
}

Reflected reflected_where(bool followed) { return followed ? Reflected::All : Reflected::None; }

bool reflects_inside(const Material& material) {
    return material.fresnel && (material.kind == MaterialKind::Coated || material.layer.inner_reflections);
}

}  // namespace

FacetNormals normals_of(const Material& material, float alpha) {
    return material.kind == MaterialKind::Coated ? FacetNormals::von_mises_fisher(alpha)
                                                 : FacetNormals(material.ndf, alpha);
}

glm::vec3 CoatingBase::fresnel(float cos_theta) const {
    return model::tinted_reflectance(layer_.base_color, layer_.edge_tint, cos_theta);
}

std::optional<CoatingBase::Sample> CoatingBase::sample(const glm::vec3& o, glm::vec2 u) const {
    if (o.z <= 0.0F) return std::nullopt;
    if (layer_.diffuse) {
        const float radius = std::sqrt(u.x);
        const float phi = 2.0F * pi * u.y;
        return Sample{{radius * std::cos(phi), radius * std::sin(phi), std::sqrt(1.0F - u.x)},
                      layer_.base_color};
    }
    const glm::vec3 m = normals_.sample(o, u);
    const float o_m = glm::dot(o, m);
    if (o_m <= 0.0F) return std::nullopt;
    const glm::vec3 i = glm::normalize(2.0F * o_m * m - o);
    if (i.z <= 0.0F) return std::nullopt;
    return Sample{i, fresnel(std::min(o_m, 1.0F)) * normals_.weight(o, m, i)};
}

CoatingBase::Value CoatingBase::evaluate(const glm::vec3& o, const glm::vec3& i) const {
    if (o.z <= 0.0F || i.z <= 0.0F) return {};
    if (layer_.diffuse) return {layer_.base_color * (i.z / pi), i.z / pi};
    const glm::vec3 m = glm::normalize(o + i);
    const float o_m = glm::dot(o, m);
    const float masking = normals_.masking(o.z) * normals_.masking(i.z);
    return {fresnel(std::min(o_m, 1.0F)) * (masking * normals_.density(m.z) / (4.0F * o.z)),
            normals_.pdf(o, m) / (4.0F * o_m)};
}

LayeredSurface::LayeredSurface(const Material& material, bool entering, float alpha, float layer_alpha)
    : LayeredSurface(
          material,
          normals_of(material, entering || material.kind == MaterialKind::Coated ? alpha : layer_alpha),
          normals_of(material, entering ? layer_alpha : alpha), layer_alpha) {}

LayeredSurface::LayeredSurface(const Material& material, const FacetNormals& near, const FacetNormals& far,
                               float base_alpha)
    : eta_(layer_index(material.ior)),
      outside_(near, eta_, material.fresnel, reflected_where(material.fresnel)),
      near_(near, 1.0F / eta_, material.fresnel, reflected_where(reflects_inside(material))),
      base_(material.layer, base_alpha) {
    if (material.kind == MaterialKind::Coated) {
        optical_depth_ = material.optical_depth();
    } else {
        far_.emplace(far, 1.0F / eta_, material.fresnel, reflected_where(reflects_inside(material)));
    }
}

glm::vec3 LayeredSurface::transmittance(float cos_theta) const {
    return glm::exp(-optical_depth_ / std::max(std::abs(cos_theta), 1e-6F));
}

}  // namespace verglas
