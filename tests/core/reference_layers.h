// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth for interfaces of vMF normals and coatings of them, independent of the core: integrals on
// grids and random walks in double precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/core/reference_lobes.h"

namespace verglas::reference {

// A3: mean resultant length.
inline double mean_length(double kappa) { return 1.0 / std::tanh(kappa) - 1.0 / kappa; }

inline double vmf(double kappa, double cosine) {
    return kappa / (2.0 * glm::pi<double>() * (1.0 - std::exp(-2.0 * kappa))) *
           std::exp(kappa * (cosine - 1.0));
}

// A direction about +Z of this distribution.
inline dvec3 draw_vmf(std::mt19937_64& random, double kappa) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double e = std::exp(-2.0 * kappa);
    const double w = -std::log(e + (1.0 - unit(random)) * (1.0 - e)) / kappa;  // 1 - cosine
    const double phi = 2.0 * glm::pi<double>() * unit(random);
    const double sine = std::sqrt(w * (2.0 - w));
    return {sine * std::cos(phi), sine * std::sin(phi), 1.0 - w};
}

// Integral of a function of unit vectors over a cone of directions with this cosine at its edge.
template <typename Function>
double over_cone(const dvec3& axis, double edge, const Function& f) {
    const dvec3 side =
        glm::normalize(glm::cross(axis, std::abs(axis.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0)));
    const dvec3 up = glm::cross(axis, side);
    constexpr int rings = 160;
    constexpr int sectors = 96;
    double sum = 0.0;
    for (int r = 0; r < rings; ++r) {
        // Rings get wider from the middle on.
        const double inner = double(r) / rings;
        const double outer = double(r + 1) / rings;
        const double w = 0.5 * (inner * inner + outer * outer) * (1.0 - edge);  // 1 - cosine
        const double solid_angle =
            2.0 * glm::pi<double>() * (outer * outer - inner * inner) * (1.0 - edge) / sectors;
        const double sine = std::sqrt(w * (2.0 - w));
        for (int s = 0; s < sectors; ++s) {
            const double phi = 2.0 * glm::pi<double>() * (s + 0.5) / sectors;
            sum += solid_angle * f((1.0 - w) * axis + sine * (std::cos(phi) * side + std::sin(phi) * up));
        }
    }
    return sum;
}

template <typename Function>
double over_hemisphere(const Function& f) {
    return over_cone(dvec3(0.0, 0.0, 1.0), 0.0, f);
}

// Integral of <o,m> M(m; n, kappa) over all m.
inline double vmf_facing_area(double kappa, double cosine) {
    const dvec3 o(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
    const double edge = std::max(1.0 - 40.0 / kappa, -1.0);  // beyond it is nothing
    return over_cone(dvec3(0.0, 0.0, 1.0), edge,
                     [&](const dvec3& m) { return std::max(glm::dot(o, m), 0.0) * vmf(kappa, m.z); });
}

// Walter et al.'s BSDF with vMF normals and their masking (the ENDF paper, eqs. 1 to 7).
class VmfInterface {
  public:
    VmfInterface(double kappa_, double eta_) : kappa(kappa_), eta(eta_) {
        for (int k = 0; k <= cosines; ++k) {
            const double cosine = std::max(double(k) / cosines, 1e-9);
            maskings.push_back(mean_length(kappa) * cosine / vmf_facing_area(kappa, cosine));
        }
    }

    double masking(double cosine) const {
        const int k = std::min(static_cast<int>(cosine * cosines), cosines - 1);
        return glm::mix(maskings[k], maskings[k + 1], cosine * cosines - k);
    }

    // Energy per solid angle that arrives from direction i for a viewer at o; n is +Z, o.z > 0.
    double density(const dvec3& o, const dvec3& i) const {
        return shape(o, i) * masking(o.z) * masking(std::abs(i.z));
    }

    // All of what is reflected, or refracted. By facets, since lobes of directions are sharp for a grid.
    double energy(const dvec3& o, bool reflect) const {
        const double edge = std::max(1.0 - 40.0 / kappa, -1.0);
        return masking(o.z) * over_cone(dvec3(0.0, 0.0, 1.0), edge, [&](const dvec3& m) {
                   const double o_m = glm::dot(o, m);
                   if (o_m <= 0.0) return 0.0;
                   const double F = fresnel(o_m, eta);
                   dvec3 i = 2.0 * o_m * m - o;
                   if (!reflect) {
                       if (F >= 1.0) return 0.0;
                       const double cos_t = std::sqrt(1.0 - (1.0 - o_m * o_m) / (eta * eta));
                       i = -o / eta + (o_m / eta - cos_t) * m;
                   }
                   if ((i.z > 0.0) != reflect) return 0.0;
                   return o_m / o.z * (reflect ? F : 1.0 - F) * masking(std::abs(i.z)) * vmf(kappa, m.z) /
                          mean_length(kappa);
               });
    }

  private:
    static constexpr int cosines = 128;

    double shape(const dvec3& o, const dvec3& i) const {
        const bool reflect = i.z > 0.0;
        dvec3 h = glm::normalize(reflect ? o + i : o + eta * i);
        if (glm::dot(o, h) < 0.0) h = -h;
        const double o_h = glm::dot(o, h);
        const double i_h = glm::dot(i, h);
        if (reflect ? i_h <= 0.0 : i_h >= 0.0) return 0.0;
        const double jacobian =
            reflect ? 1.0 / (4.0 * i_h) : eta * eta * std::abs(i_h) / std::pow(o_h + eta * i_h, 2.0);
        const double F = fresnel(o_h, eta);
        return o_h * (reflect ? F : 1.0 - F) * vmf(kappa, h.z) / mean_length(kappa) * jacobian / o.z;
    }

    double kappa;
    double eta;
    std::vector<double> maskings;  // at cosines from 0 to 1
};

// Of a white mirror of vMF normals under a layer of glass: what leaves it for a viewer at this cosine, after
// at most so many bounces at the mirror. A random walk that draws visible facets by rejection; masking of
// what they send on is then all that weighs.
inline double coated_albedo(double kappa, double base_kappa, double eta, int bounces, double cosine) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto visible = [&](const dvec3& o, double k) {
        for (;;) {
            const dvec3 m = draw_vmf(random, k);
            const double o_m = glm::dot(o, m);
            if (o_m > 0.0 && unit(random) < o_m) return m;
        }
    };
    const VmfInterface outer(kappa, eta);
    const VmfInterface inner(base_kappa, eta);
    // Draws what an interface does with light toward o; returns the weight.
    const auto meet = [&](dvec3& o, double n, bool& reflected) {
        const dvec3 m = visible(o, kappa);
        const double o_m = glm::dot(o, m);
        reflected = unit(random) < fresnel(o_m, n);
        dvec3 i = 2.0 * o_m * m - o;
        if (!reflected) i = -o / n + (o_m / n - std::sqrt(1.0 - (1.0 - o_m * o_m) / (n * n))) * m;
        o = i;
        return (i.z > 0.0) == reflected ? outer.masking(std::abs(i.z)) : 0.0;
    };
    double sum = 0.0;
    constexpr int count = 60000;
    for (int path = 0; path < count; ++path) {
        dvec3 o(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
        bool reflected = false;
        double weight = meet(o, eta, reflected);
        for (int bounce = 0; !reflected && weight > 0.0; ++bounce) {
            if (bounce == bounces) weight = 0.0;
            o = -o;
            const dvec3 m = visible(o, base_kappa);
            const dvec3 up = 2.0 * glm::dot(o, m) * m - o;
            weight *= up.z > 0.0 ? inner.masking(up.z) : 0.0;
            if (weight <= 0.0) break;
            // Seen from within, the outer side's normal is turned.
            o = dvec3(-up.x, -up.y, up.z);
            bool stays = false;
            weight *= meet(o, 1.0 / eta, stays);
            if (!stays) break;
            o = dvec3(o.x, o.y, -o.z);
        }
        sum += weight;
    }
    return sum / count;
}

}  // namespace verglas::reference
