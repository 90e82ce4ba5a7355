// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/microfacet.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/material/model.h"

namespace verglas {
namespace {

constexpr float pi = glm::pi<float>();

// D(m), per steradian; D(m) (m.n) integrates to 1 over the hemisphere.
float microfacet_distribution(Ndf ndf, float alpha, float cos_theta_m) {
    if (cos_theta_m <= 0.0F) return 0.0F;
    const float alpha2 = alpha * alpha;
    const float cos2 = cos_theta_m * cos_theta_m;
    if (ndf == Ndf::BlinnPhong) {
        const float n_D = 2.0F / alpha2 - 2.0F;
        return (n_D + 2.0F) / (2.0F * pi) * std::pow(cos_theta_m, n_D);
    }
    if (ndf == Ndf::Ggx) {
        const float denominator = (1.0F - cos2) + alpha2 * cos2;  // in this order more than 0 for any alpha
        return alpha2 / (pi * denominator * denominator);
    }
    return std::exp((cos2 - 1.0F) / (cos2 * alpha2)) / (pi * alpha2 * cos2 * cos2);
}

// Masking whose visible normals are exactly normalised; for Beckmann the model's own is a rational
// approximation.
float exact_masking(Ndf ndf, float alpha, float cos_theta) {
    if (ndf == Ndf::Ggx) return model::smith_masking(model::NDF_GGX, alpha, cos_theta);
    const float tan_theta = std::sqrt(std::max(1.0F - cos_theta * cos_theta, 0.0F)) / cos_theta;
    const float a = 1.0F / std::max(alpha * tan_theta, 1e-6F);
    if (a > 6.0F) return 1.0F;
    return 2.0F / (1.0F + std::erf(a) + std::exp(-a * a) / (a * std::sqrt(pi)));
}

// Slope toward the viewer of a visible facet of Beckmann's distribution with alpha 1: density in proportion
// to (cos - x sin) exp(-x^2) for x < cot. Its integral up to x is cos (1 + erf x) / 2 + sin exp(-x^2) / (2
// sqrt(pi)).
float sample_visible_slope(float cos_theta, float u) {
    const float sin_theta = std::sqrt(std::max(1.0F - cos_theta * cos_theta, 0.0F));
    const auto cumulative = [cos_theta, sin_theta](float x) {
        return cos_theta * 0.5F * (1.0F + std::erf(x)) +
               sin_theta * std::exp(-x * x) / (2.0F * std::sqrt(pi));
    };
    // Newton steps, kept within what is known to hold the solution.
    float low = -6.0F;
    float high = std::min(cos_theta / std::max(sin_theta, 1e-6F), 6.0F);
    const float wanted = u * cumulative(high);
    float x = std::min(0.0F, 0.5F * (low + high));
    for (int i = 0; i < 24; ++i) {
        const float error = cumulative(x) - wanted;
        if (std::abs(error) < 1e-6F) break;
        (error < 0.0F ? low : high) = x;
        const float density = (cos_theta - x * sin_theta) * std::exp(-x * x) / std::sqrt(pi);
        const float next = x - error / std::max(density, 1e-12F);
        x = next > low && next < high ? next : 0.5F * (low + high);
    }
    return x;
}

// Inverse of erf by Newton steps on Winitzki's approximation.
float inverse_erf(float y) {
    const float c = std::clamp(y, -0.999999F, 0.999999F);
    const float l = std::log(1.0F - c * c);
    const float t = 2.0F / (pi * 0.147F) + 0.5F * l;
    float x = std::copysign(std::sqrt(std::sqrt(t * t - l / 0.147F) - t), c);
    for (int i = 0; i < 2; ++i) x -= (std::erf(x) - c) / (2.0F / std::sqrt(pi) * std::exp(-x * x));
    return x;
}

// A visible normal of Beckmann's distribution: stretched to alpha 1, slopes drawn along and across the view.
glm::vec3 sample_visible_beckmann(float alpha, const glm::vec3& o, glm::vec2 u) {
    const glm::vec3 stretched = glm::normalize(glm::vec3(alpha * o.x, alpha * o.y, o.z));
    const float along = sample_visible_slope(stretched.z, u.x);
    const float across = inverse_erf(2.0F * u.y - 1.0F);
    const float sine = std::hypot(stretched.x, stretched.y);
    const glm::vec2 view = sine > 1e-6F ? glm::vec2(stretched.x, stretched.y) / sine : glm::vec2(1.0F, 0.0F);
    const glm::vec2 slope = alpha * (along * view + across * glm::vec2(-view.y, view.x));
    // A facet of slope p has the normal (-p, 1); slopes that fall away from the viewer are hidden.
    return glm::normalize(glm::vec3(-slope, 1.0F));
}

// A visible normal of GGX: a point of the projected hemisphere (Heitz 2018).
glm::vec3 sample_visible_ggx(float alpha, const glm::vec3& o, glm::vec2 u) {
    const glm::vec3 v = glm::normalize(glm::vec3(alpha * o.x, alpha * o.y, o.z));
    const float sine = std::hypot(v.x, v.y);
    const glm::vec3 t1 = sine > 1e-6F ? glm::vec3(-v.y, v.x, 0.0F) / sine : glm::vec3(1.0F, 0.0F, 0.0F);
    const glm::vec3 t2 = glm::cross(v, t1);
    const float r = std::sqrt(u.x);
    const float phi = 2.0F * pi * u.y;
    const float a = r * std::cos(phi);
    const float s = 0.5F * (1.0F + v.z);
    const float b = (1.0F - s) * std::sqrt(std::max(1.0F - a * a, 0.0F)) + s * r * std::sin(phi);
    const glm::vec3 h = a * t1 + b * t2 + std::sqrt(std::max(1.0F - a * a - b * b, 0.0F)) * v;
    return glm::normalize(glm::vec3(alpha * h.x, alpha * h.y, std::max(h.z, 1e-6F)));
}

// Blinn-Phong has no closed form of its visible normals: D(m) (m.n) (Walter et al. 2007, eq. 35).
glm::vec3 sample_blinn_phong(float alpha, glm::vec2 u) {
    const float cosine = std::pow(1.0F - u.x, 0.5F * alpha * alpha);
    const float sine = std::sqrt(std::max(1.0F - cosine * cosine, 0.0F));
    const float phi = 2.0F * pi * u.y;
    return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

}  // namespace

glm::vec3 RoughInterface::sample_normal(const glm::vec3& o, glm::vec2 u) const {
    switch (ndf_) {
        case Ndf::Beckmann:
            return sample_visible_beckmann(alpha_, o, u);
        case Ndf::Ggx:
            return sample_visible_ggx(alpha_, o, u);
        case Ndf::BlinnPhong:
            break;
    }
    return sample_blinn_phong(alpha_, u);
}

float RoughInterface::normal_pdf(const glm::vec3& o, const glm::vec3& m) const {
    const float D = microfacet_distribution(ndf_, alpha_, m.z);
    if (ndf_ == Ndf::BlinnPhong) return D * m.z;
    return exact_masking(ndf_, alpha_, o.z) * std::max(glm::dot(o, m), 0.0F) * D / o.z;
}

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

// f cos / pdf without F, and without the D and the Jacobian that both have.
float RoughInterface::masking_weight(const glm::vec3& o, const glm::vec3& m, const glm::vec3& i) const {
    const float masking = model::smith_masking(static_cast<int>(ndf_), alpha_, o.z) *
                          model::smith_masking(static_cast<int>(ndf_), alpha_, std::abs(i.z));
    return ndf_ == Ndf::BlinnPhong ? masking * glm::dot(o, m) / (o.z * m.z)
                                   : masking / exact_masking(ndf_, alpha_, o.z);
}

std::optional<RoughInterface::Sample> RoughInterface::sample(const glm::vec3& o, glm::vec2 u,
                                                             float choice) const {
    if (o.z <= 0.0F) return std::nullopt;
    const glm::vec3 m = sample_normal(o, u);
    const float o_m = glm::dot(o, m);
    if (o_m <= 0.0F) return std::nullopt;
    const float share = reflected_share(o_m);
    const auto i = direction(o, m, choice < share ? Event::Reflect : Event::Refract);
    if (!i) return std::nullopt;
    float weight = masking_weight(o, m, *i);
    if (i->z < 0.0F) weight *= (1.0F - fresnel(o_m)) / (1.0F - share);
    return Sample{*i, weight, evaluate(o, *i).pdf};
}

std::optional<RoughInterface::Sample> RoughInterface::sample(const glm::vec3& o, glm::vec2 u,
                                                             Event event) const {
    if (o.z <= 0.0F) return std::nullopt;
    const glm::vec3 m = sample_normal(o, u);
    const auto i = direction(o, m, event);
    if (!i) return std::nullopt;
    const float F = fresnel(glm::dot(o, m));
    return Sample{*i, masking_weight(o, m, *i) * (event == Event::Reflect ? F : 1.0F - F), 0.0F};
}

RoughInterface::Value RoughInterface::evaluate(const glm::vec3& o, const glm::vec3& i) const {
    const bool reflected = i.z > 0.0F;
    if (o.z <= 0.0F || i.z == 0.0F) return {};
    glm::vec3 m = reflected ? o + i : o + eta_ * i;
    const float length = glm::length(m);
    if (length < 1e-7F) return {};
    m = m / (m.z < 0.0F ? -length : length);
    const float o_m = glm::dot(o, m);
    const float i_m = glm::dot(i, m);
    if (o_m <= 0.0F || (reflected ? i_m <= 0.0F : i_m >= 0.0F)) return {};
    const float denominator = o_m + eta_ * i_m;
    const float jacobian =
        reflected ? 0.25F / i_m : eta_ * eta_ * -i_m / std::max(denominator * denominator, 1e-12F);
    const float share = reflected_share(o_m);
    const int ndf = static_cast<int>(ndf_);
    const float masking =
        model::smith_masking(ndf, alpha_, o.z) * model::smith_masking(ndf, alpha_, std::abs(i.z));
    Value value;
    value.f_cos = o_m * masking * (reflected ? share : 1.0F - fresnel(o_m)) *
                  microfacet_distribution(ndf_, alpha_, m.z) * jacobian / o.z;
    value.pdf = normal_pdf(o, m) * jacobian * (reflected ? share : 1.0F - share);
    return value;
}

// Of a facet that lies in the surface. Its normals' concentration, 2 / alpha^2, times the Jacobian of
// reflection or refraction; at grazing exits the lobe would have no end.
RoughInterface::Lobe RoughInterface::lobe(const glm::vec3& o, bool reflected) const {
    const float kappa_m = 2.0F / (alpha_ * alpha_);
    const float o_m = std::max(o.z, 1e-3F);
    if (reflected) return {glm::vec3(-o.x, -o.y, o.z), kappa_m / (4.0F * o_m)};
    const glm::vec3 axis = model::specular_direction(eta_, -o, glm::vec3(0.0F, 0.0F, 1.0F), model::TIR_CLAMP);
    const float t_m = std::max(-axis.z, 0.1F);
    const float denominator = o_m - eta_ * t_m;
    return {axis, kappa_m * eta_ * eta_ * t_m / std::max(denominator * denominator, 1e-6F)};
}

}  // namespace verglas
