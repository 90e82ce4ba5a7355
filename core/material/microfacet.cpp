// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/microfacet.h"

#include <algorithm>
#include <cmath>

#include "core/material/model.h"

namespace verglas {

// F of a facet.
float RoughInterface::fresnel(float o_m) const {
    if (fresnel_) return model::fresnel_dielectric(o_m, eta_);
    return o_m <= model::critical_cosine(eta_) ? 1.0F : 0.0F;
}

// The part of F that is followed, and so drawn.
float RoughInterface::reflected_share(float o_m) const {
    switch (reflected_) {
        case Reflected::None:
            break;
        case Reflected::Total:
            return o_m <= model::critical_cosine(eta_) ? 1.0F : 0.0F;
        case Reflected::All:
            return fresnel(o_m);
    }
    return 0.0F;
}

// Where a facet sends light, seen from o; none where that isn't possible or lies on the other side of the
// surface.
std::optional<glm::vec3> RoughInterface::direction(const glm::vec3& o, const glm::vec3& m,
                                                   Event event) const {
    const float o_m = glm::dot(o, m);
    if (o_m <= 0.0F) return std::nullopt;
    if (event == Event::Reflect) {
        const glm::vec3 i = 2.0F * o_m * m - o;
        return i.z > 0.0F ? std::optional(glm::normalize(i)) : std::nullopt;
    }
    const float cos2_t = 1.0F - (1.0F - o_m * o_m) / (eta_ * eta_);
    if (cos2_t <= 0.0F) return std::nullopt;
    const glm::vec3 i = -o / eta_ + (o_m / eta_ - std::sqrt(cos2_t)) * m;
    return i.z < 0.0F ? std::optional(glm::normalize(i)) : std::nullopt;
}

std::optional<RoughInterface::Sample> RoughInterface::sample(const glm::vec3& o, glm::vec2 u,
                                                             float choice) const {
    if (o.z <= 0.0F) return std::nullopt;
    const glm::vec3 m = normals_.sample(o, u);
    const float o_m = glm::dot(o, m);
    if (o_m <= 0.0F) return std::nullopt;
    const float share = reflected_share(o_m);
    const auto i = direction(o, m, choice < share ? Event::Reflect : Event::Refract);
    if (!i) return std::nullopt;
    float weight = normals_.weight(o, m, *i);
    if (i->z < 0.0F) weight *= (1.0F - fresnel(o_m)) / (1.0F - share);
    return Sample{*i, weight, evaluate(o, *i).pdf};
}

std::optional<RoughInterface::Sample> RoughInterface::sample(const glm::vec3& o, glm::vec2 u,
                                                             Event event) const {
    if (o.z <= 0.0F) return std::nullopt;
    const glm::vec3 m = normals_.sample(o, u);
    const auto i = direction(o, m, event);
    if (!i) return std::nullopt;
    const float F = fresnel(glm::dot(o, m));
    return Sample{*i, normals_.weight(o, m, *i) * (event == Event::Reflect ? F : 1.0F - F), 0.0F};
}

RoughInterface::Value RoughInterface::evaluate(const glm::vec3& o, const glm::vec3& i) const {
    const bool reflected = i.z > 0.0F;
    if (o.z <= 0.0F || i.z == 0.0F) return {};
    glm::vec3 m = reflected ? o + i : o + eta_ * i;
    const float length = glm::length(m);
    if (length < 1e-7F) return {};
    m = m / (glm::dot(o, m) < 0.0F ? -length : length);
    const float o_m = glm::dot(o, m);
    const float i_m = glm::dot(i, m);
    if (o_m <= 0.0F || (reflected ? i_m <= 0.0F : i_m >= 0.0F)) return {};
    const float denominator = o_m + eta_ * i_m;
    const float jacobian =
        reflected ? 0.25F / i_m : eta_ * eta_ * -i_m / std::max(denominator * denominator, 1e-12F);
    const float share = reflected_share(o_m);
    const float masking = normals_.masking(o.z) * normals_.masking(std::abs(i.z));
    Value value;
    value.f_cos =
        o_m * masking * (reflected ? share : 1.0F - fresnel(o_m)) * normals_.density(m.z) * jacobian / o.z;
    value.pdf = normals_.pdf(o, m) * jacobian * (reflected ? share : 1.0F - share);
    return value;
}

// Of a facet that lies in the surface. Its normals' concentration times the Jacobian of
// reflection or refraction; at grazing exits the lobe would have no end.
RoughInterface::Lobe RoughInterface::lobe(const glm::vec3& o, bool reflected) const {
    const float kappa_m = normals_.kappa();
    const float o_m = std::max(o.z, 1e-3F);
    if (reflected) return {glm::vec3(-o.x, -o.y, o.z), kappa_m / (4.0F * o_m)};
    const glm::vec3 axis = model::specular_direction(eta_, -o, glm::vec3(0.0F, 0.0F, 1.0F), model::TIR_CLAMP);
    const float t_m = std::max(-axis.z, 0.1F);
    const float denominator = o_m - eta_ * t_m;
    return {axis, kappa_m * eta_ * eta_ * t_m / std::max(denominator * denominator, 1e-6F)};
}

}  // namespace verglas
