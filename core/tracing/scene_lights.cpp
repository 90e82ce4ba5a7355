// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/scene_lights.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "core/math/frame.h"

namespace verglas {
namespace {

constexpr float pi = glm::pi<float>();
constexpr float infinity = std::numeric_limits<float>::infinity();

// Directions in which a light is seen.
struct Cone {
    glm::vec3 axis;
    float one_minus_cosine;  // of its half angle; 0 for one direction
    float distance;          // of its middle
};

Cone cone_of(const Light& light, const glm::vec3& from) {
    if (light.kind == LightKind::Sun) {
        const float sine = std::sin(0.5F * std::min(light.radius, pi));
        return {light.place, 2.0F * sine * sine, infinity};
    }
    const glm::vec3 way = light.place - from;
    const float distance = std::max(glm::length(way), 1e-12F);
    if (distance <= light.radius) return {way / distance, 2.0F, distance};  // from within, everywhere
    const float sine = light.radius / distance;
    const float sin2 = sine * sine;
    return {way / distance, sin2 / (1.0F + std::sqrt(1.0F - sin2)), distance};
}

// Of a sphere whose intensity is that of radiance on its disk: L pi r^2. What a disk shines goes by the
// cosine to its axis.
float share_toward(const Light& light, const glm::vec3& axis) {
    return light.kind == LightKind::Disk ? std::max(-glm::dot(axis, light.axis), 0.0F) : 1.0F;
}

// See SceneLights::Sample::light.
glm::vec3 light_of(const Light& light, const Cone& cone) {
    if (light.kind == LightKind::Sun) {
        const float sin2 = cone.one_minus_cosine * (2.0F - cone.one_minus_cosine);
        return cone.one_minus_cosine > 0.0F ? light.intensity / (pi * std::max(sin2, 1e-12F))
                                            : light.intensity;
    }
    const glm::vec3 intensity = light.intensity * share_toward(light, cone.axis);
    const float length = cone.one_minus_cosine > 0.0F ? light.radius : cone.distance;
    return intensity / (length * length * (cone.one_minus_cosine > 0.0F ? pi : 1.0F));
}

float pdf_of(const Cone& cone) {
    return cone.one_minus_cosine > 0.0F ? 1.0F / (2.0F * pi * cone.one_minus_cosine) : 0.0F;
}

// To where a ray meets the light, or passes nearest to its middle.
float distance_to(const Light& light, const Cone& cone, const glm::vec3& direction) {
    if (light.kind == LightKind::Sun) return infinity;
    const float along = cone.distance * glm::dot(cone.axis, direction);
    const float across2 = cone.distance * cone.distance - along * along;
    const float half = std::sqrt(std::max(light.radius * light.radius - across2, 0.0F));
    return along - half > 0.0F ? along - half : along + half;
}

SceneLights::Sample seen(const Light& light, const Cone& cone, const glm::vec3& direction) {
    return {direction, distance_to(light, cone, direction), light_of(light, cone), pdf_of(cone)};
}

}  // namespace

SceneLights::Sample SceneLights::sample(std::size_t index, const glm::vec3& from, glm::vec2 u) const {
    const Light& light = lights_[index];
    const Cone cone = cone_of(light, from);
    if (cone.one_minus_cosine <= 0.0F) return seen(light, cone, cone.axis);
    const float w = u.x * cone.one_minus_cosine;
    const float sine = std::sqrt(w * (2.0F - w));
    const float phi = 2.0F * pi * u.y;
    return seen(light, cone,
                glm::normalize(frame_of(cone.axis) *
                               glm::vec3(sine * std::cos(phi), sine * std::sin(phi), 1.0F - w)));
}

std::optional<SceneLights::Sample> SceneLights::at(std::size_t index, const glm::vec3& from,
                                                   const glm::vec3& direction) const {
    const Light& light = lights_[index];
    if (light.radius <= 0.0F) return std::nullopt;
    const Cone cone = cone_of(light, from);
    const glm::vec3 off = direction - cone.axis;
    if (0.5F * glm::dot(off, off) > cone.one_minus_cosine) return std::nullopt;  // 1 - cos
    return seen(light, cone, direction);
}

}  // namespace verglas
