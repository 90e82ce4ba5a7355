// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth for lobes, independent of the core: Walter et al.'s BSDF (2007, eqs. 20 and 21) written out in
// double precision and integrated over DIRECTIONS, where the core samples microfacet normals.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>

#include "core/material/lobe_tables.h"

namespace verglas::reference {

using glm::dvec3;

inline double distribution(Ndf ndf, double alpha, double cosine) {
    if (cosine <= 0.0) return 0.0;
    const double cos2 = cosine * cosine;
    const double tan2 = (1.0 - cos2) / cos2;
    if (ndf == Ndf::BlinnPhong) {
        const double exponent = 2.0 / (alpha * alpha) - 2.0;
        return (exponent + 2.0) / (2.0 * glm::pi<double>()) * std::pow(cosine, exponent);
    }
    if (ndf == Ndf::Ggx)
        return alpha * alpha / (glm::pi<double>() * cos2 * cos2 * std::pow(alpha * alpha + tan2, 2.0));
    return std::exp(-tan2 / (alpha * alpha)) / (glm::pi<double>() * alpha * alpha * cos2 * cos2);
}

inline double masking(Ndf ndf, double alpha, double cosine) {
    const double tangent = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / cosine;
    if (ndf == Ndf::Ggx) return 2.0 / (1.0 + std::sqrt(1.0 + alpha * alpha * tangent * tangent));
    const double a = 1.0 / (alpha * tangent);
    if (!(a < 1.6)) return 1.0;
    return (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a);
}

// From Snell's law and Fresnel's amplitudes, not from the core's closed form.
inline double fresnel(double cos_i, double eta) {
    const double sin_t = std::sqrt(std::max(0.0, 1.0 - cos_i * cos_i)) / eta;
    if (sin_t >= 1.0) return 1.0;
    const double cos_t = std::sqrt(1.0 - sin_t * sin_t);
    const double s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return 0.5 * (s * s + p * p);
}

// Energy per solid angle that arrives from direction i (|i| = 1; n is +Z, o.z > 0) for a viewer at o.
inline double density(Ndf ndf, double alpha, double eta, LobeEvent event, const dvec3& o, const dvec3& i) {
    const bool reflect = event == LobeEvent::Reflect;
    if (reflect ? i.z <= 0.0 : i.z >= 0.0) return 0.0;
    dvec3 h = reflect ? o + i : o + eta * i;
    if (glm::length(h) < 1e-12) return 0.0;
    h = glm::normalize(h);
    if (h.z < 0.0) h = -h;
    const double o_h = glm::dot(o, h);
    const double i_h = glm::dot(i, h);
    if (o_h <= 0.0 || (reflect ? i_h <= 0.0 : i_h >= 0.0)) return 0.0;
    const double jacobian =
        reflect ? 1.0 / (4.0 * i_h) : eta * eta * std::abs(i_h) / std::pow(o_h + eta * i_h, 2.0);
    const double F = fresnel(o_h, eta);
    const double factor = event == LobeEvent::Refract ? 1.0 - F : reflect ? F : 1.0;
    return o_h * factor * masking(ndf, alpha, o.z) * masking(ndf, alpha, std::abs(i.z)) *
           distribution(ndf, alpha, h.z) * jacobian / o.z;
}

struct Moments {
    double energy = 0.0;
    dvec3 vector{0.0};

    dvec3 direction() const { return glm::normalize(vector); }
    double spread() const { return 1.0 - glm::length(vector) / energy; }
};

// Integrates over a polar grid about the specular direction, with radii in geometric progression.
inline Moments integrate(Ndf ndf, double alpha, double eta, LobeEvent event, double cos_theta_o) {
    const double sin_o = std::sqrt(1.0 - cos_theta_o * cos_theta_o);
    const dvec3 o(sin_o, 0.0, cos_theta_o);
    dvec3 axis(-sin_o, 0.0, cos_theta_o);
    if (event != LobeEvent::Reflect) {
        const double sin_t = std::min(sin_o / eta, 1.0);
        axis = dvec3(-sin_t, 0.0, -std::sqrt(1.0 - sin_t * sin_t));
    }
    const dvec3 side(0.0, 1.0, 0.0);
    const dvec3 up = glm::cross(side, axis);
    constexpr int rings = 900;
    constexpr int sectors = 180;  // over half a turn: the lobe is symmetric
    const double smallest = 1e-4 * std::min(alpha * alpha + alpha * std::abs(std::log(eta)), 1.0);
    Moments sum;
    for (int r = 0; r < rings; ++r) {
        const double inner =
            r == 0 ? 0.0 : smallest * std::pow(glm::pi<double>() / smallest, double(r) / rings);
        const double outer = smallest * std::pow(glm::pi<double>() / smallest, double(r + 1) / rings);
        const double angle = 0.5 * (inner + outer);
        const double ring = std::cos(inner) - std::cos(outer);
        const double solid_angle =
            2.0 * glm::pi<double>() / sectors * (outer < 1e-3 ? 0.5 * (outer * outer - inner * inner) : ring);
        for (int s = 0; s < sectors; ++s) {
            const double azimuth = glm::pi<double>() * (s + 0.5) / sectors;
            const dvec3 i = std::cos(angle) * axis +
                            std::sin(angle) * (std::cos(azimuth) * up + std::sin(azimuth) * side);
            const double e = density(ndf, alpha, eta, event, o, i) * solid_angle;
            sum.energy += e;
            sum.vector += e * dvec3(i.x, 0.0, i.z);
        }
    }
    return sum;
}

}  // namespace verglas::reference
