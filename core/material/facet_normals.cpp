// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/facet_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace verglas {
namespace {

constexpr float pi = glm::pi<float>();

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

float mean_resultant_length(float kappa) { return 1.0F - model::spread_from_kappa(kappa); }

// exp(-x) I0(x), x >= 0 (Abramowitz and Stegun, 9.8.1 and 9.8.2).
double scaled_bessel_i0(double x) {
    if (x < 3.75) {
        const double t = x * x / (3.75 * 3.75);
        const double i0 =
            1.0 + t * (3.5156229 +
                       t * (3.0899424 + t * (1.2067492 + t * (0.2659732 + t * (0.0360768 + t * 0.0045813)))));
        return std::exp(-x) * i0;
    }
    const double t = 3.75 / x;
    return (0.39894228 +
            t * (0.01328592 +
                 t * (0.00225319 + t * (-0.00157565 +
                                        t * (0.00916281 + t * (-0.02057706 +
                                                               t * (0.02635537 + t * (-0.01647633 +
                                                                                      t * 0.00392377)))))))) /
           std::sqrt(x);
}

// vmf_facing_area() by integration over the angle theta between o and m; about the axis o, the integral over
// the azimuth is a Bessel function.
double integrated_facing_area(double kappa, double theta_o) {
    const double reach = 9.0 / std::sqrt(kappa);
    const double first = std::max(theta_o - reach, 0.0);
    const double last = std::min(theta_o + reach, 0.5 * glm::pi<double>());
    constexpr int steps = 400;
    const double step = (last - first) / steps;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double theta = first + (i + 0.5) * step;
        sum += std::cos(theta) * std::sin(theta) * std::exp(kappa * (std::cos(theta - theta_o) - 1.0)) *
               scaled_bessel_i0(kappa * std::sin(theta) * std::sin(theta_o));
    }
    return sum * step * kappa / (1.0 - std::exp(-2.0 * kappa));
}

// The ratio of that to the closed form, which is smooth, and 1 for sharp distributions.
class FacingAreaRatios {
  public:
    FacingAreaRatios() {
        for (int j = 0; j < kappas; ++j) {
            const double kappa = std::exp(last_log * j / (kappas - 1));
            for (int i = 0; i < angles; ++i) {
                const double theta = 0.5 * glm::pi<double>() * i / (angles - 1);
                const float approximation =
                    model::approximate_facing_area(static_cast<float>(kappa), float(std::cos(theta)));
                ratios_[j * angles + i] =
                    static_cast<float>(integrated_facing_area(kappa, theta)) / approximation;
            }
        }
    }

    float at(float kappa, float cosine) const {
        const float y = std::log(kappa) / last_log * (kappas - 1);
        if (y >= kappas - 1) return 1.0F;
        const float x = std::acos(std::clamp(cosine, 0.0F, 1.0F)) / (0.5F * pi) * (angles - 1);
        const int i = std::min(static_cast<int>(x), angles - 2);
        const int j = std::max(static_cast<int>(y), 0);
        const float* const row = &ratios_[j * angles + i];
        const glm::vec2 near = glm::mix(glm::vec2(row[0], row[angles]), glm::vec2(row[1], row[angles + 1]),
                                        x - static_cast<float>(i));
        return glm::mix(near.x, near.y, std::max(y, 0.0F) - static_cast<float>(j));
    }

  private:
    static constexpr int kappas = 65;
    static constexpr int angles = 257;
    static constexpr float last_log = 9.0F;

    std::array<float, std::size_t(kappas) * angles> ratios_;
};

}  // namespace

float vmf_facing_area(float kappa, float cos_theta) {
    const float area = model::approximate_facing_area(kappa, cos_theta);
    // As good as no facet looks away: then it is the mean of o.m.
    if (area <= mean_resultant_length(kappa) * cos_theta) return area;
    static const FacingAreaRatios ratios;
    return ratios.at(kappa, cos_theta) * area;
}

FacetNormals FacetNormals::von_mises_fisher(float alpha) {
    return {Kind::VonMisesFisher, std::min(alpha, max_vmf_alpha)};
}

float FacetNormals::density(float cos_theta_m) const {
    if (kind_ == Kind::VonMisesFisher) return vmf_.density(cos_theta_m) / mean_resultant_length(kappa());
    if (cos_theta_m <= 0.0F) return 0.0F;
    const float alpha2 = alpha_ * alpha_;
    const float cos2 = cos_theta_m * cos_theta_m;
    if (kind_ == Kind::BlinnPhong) {
        const float n_D = 2.0F / alpha2 - 2.0F;
        return (n_D + 2.0F) / (2.0F * pi) * std::pow(cos_theta_m, n_D);
    }
    if (kind_ == Kind::Ggx) {
        const float denominator = (1.0F - cos2) + alpha2 * cos2;  // in this order more than 0 for any alpha
        return alpha2 / (pi * denominator * denominator);
    }
    return std::exp((cos2 - 1.0F) / (cos2 * alpha2)) / (pi * alpha2 * cos2 * cos2);
}

glm::vec3 FacetNormals::sample(const glm::vec3& o, glm::vec2 u) const {
    switch (kind_) {
        case Kind::Beckmann:
            return sample_visible_beckmann(alpha_, o, u);
        case Kind::Ggx:
            return sample_visible_ggx(alpha_, o, u);
        case Kind::BlinnPhong:
            return sample_blinn_phong(alpha_, u);
        case Kind::VonMisesFisher:
            break;
    }
    return vmf_.sample(u);
}

float FacetNormals::pdf(const glm::vec3& o, const glm::vec3& m) const {
    if (kind_ == Kind::VonMisesFisher) return vmf_.density(m.z);
    const float D = density(m.z);
    if (kind_ == Kind::BlinnPhong) return D * m.z;
    return exact_masking(static_cast<Ndf>(kind_), alpha_, o.z) * std::max(glm::dot(o, m), 0.0F) * D / o.z;
}

// For vMF normals by the area that looks toward the direction (the ENDF paper, eq. 7).
float FacetNormals::masking(float cos_theta) const {
    if (kind_ == Kind::VonMisesFisher)
        return mean_resultant_length(kappa()) * cos_theta / vmf_facing_area(kappa(), cos_theta);
    return model::smith_masking(static_cast<int>(kind_), alpha_, cos_theta);
}

float FacetNormals::weight(const glm::vec3& o, const glm::vec3& m, const glm::vec3& i) const {
    const float o_m = glm::dot(o, m);
    const float of_i = masking(std::abs(i.z));
    switch (kind_) {
        case Kind::Beckmann:
        case Kind::Ggx:
            return masking(o.z) * of_i / exact_masking(static_cast<Ndf>(kind_), alpha_, o.z);
        case Kind::BlinnPhong:
            return masking(o.z) * of_i * o_m / (o.z * m.z);
        case Kind::VonMisesFisher:
            break;
    }
    return of_i * o_m / vmf_facing_area(kappa(), o.z);
}

}  // namespace verglas
