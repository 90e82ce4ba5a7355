// SPDX-License-Identifier: GPL-3.0-or-later
// A ray at a surface: what the tracers need of its hit.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "core/material/model.h"
#include "core/tracing/ray_scene.h"

namespace verglas {

// d: the ray's direction.
inline bool is_entering(const Hit& hit, const glm::vec3& d) {
    return glm::dot(d, hit.geometric_normal) < 0.0F;
}

// The interpolated normal on the side that the ray comes from. At silhouettes it may face away; it is bent as
// in refraction.frag.glsl.
inline glm::vec3 facing_normal(const Hit& hit, const glm::vec3& d) {
    const glm::vec3 n = is_entering(hit, d) ? hit.normal : -hit.normal;
    return glm::normalize(n - std::max(glm::dot(n, d) + 1e-3F, 0.0F) * d);
}

// A point beside the surface on the side that a ray leaves to, far enough that it does not meet it again.
inline glm::vec3 beside(const Hit& hit, const glm::vec3& d) {
    const glm::vec3& p = hit.position;
    const float scale = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), hit.t, 1e-3F});
    return p + (is_entering(hit, d) ? -1.0F : 1.0F) * 4e-6F * scale * hit.geometric_normal;
}

inline float roughness_at(float value, const std::shared_ptr<const Texture>& texture, const Hit& hit) {
    return texture ? std::clamp(texture->sample(hit.uv), 0.0F, 1.0F) : value;
}

// 0 … 1, of the material at the hit.
inline float roughness_at(const Material& material, const Hit& hit) {
    return roughness_at(material.roughness, material.roughness_texture, hit);
}

// The same of the inner side of a thin layer.
inline float inner_roughness_at(const Material& material, const Hit& hit) {
    return roughness_at(material.layer.roughness, material.layer.roughness_texture, hit);
}

// Width of the distribution that facets are drawn from. Sharper ones are beyond float; such glass is as good
// as clear.
inline float facet_alpha(float roughness) { return std::max(model::alpha_from_roughness(roughness), 1e-4F); }

}  // namespace verglas
