// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth for light through a rough glass sphere, independent of the core: random paths through its two
// interfaces (Walter et al. 2007) with Blinn-Phong normals, in double precision.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <random>

#include "tests/core/reference_lobes.h"

namespace verglas::reference {

// One random path through an interface: direction d becomes the refracted one, the result is Walter's weight
// for normals drawn from D(m) (m.n).
inline double refract(dvec3& d, const dvec3& n, double eta, double exponent, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double alpha = std::sqrt(2.0 / (exponent + 2.0));
    const double cos_m = std::pow(1.0 - unit(random), 1.0 / (exponent + 2.0));
    const double azimuth = 2.0 * glm::pi<double>() * unit(random);
    const dvec3 s = glm::normalize(glm::cross(n, std::abs(n.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0)));
    const dvec3 t = glm::cross(n, s);
    const dvec3 m =
        cos_m * n + std::sqrt(1.0 - cos_m * cos_m) * (std::cos(azimuth) * s + std::sin(azimuth) * t);
    const double o_m = -glm::dot(d, m);
    const double o_n = -glm::dot(d, n);
    if (o_m <= 0.0 || o_n <= 0.0) return 0.0;
    const double cos2_t = 1.0 - (1.0 - o_m * o_m) / (eta * eta);
    if (cos2_t <= 0.0) return 0.0;
    d = glm::normalize(d / eta + (o_m / eta - std::sqrt(cos2_t)) * m);
    const double i_n = -glm::dot(d, n);
    if (i_n <= 0.0) return 0.0;
    return o_m * masking(Ndf::BlinnPhong, alpha, o_n) * masking(Ndf::BlinnPhong, alpha, i_n) *
           (1.0 - fresnel(o_m, eta)) / (o_n * cos_m);
}

// Where a ray along -Z at offset b from the centre meets the unit sphere, and where a ray inside leaves it.
inline dvec3 entry_point(double b) { return {0.0, b, std::sqrt(1.0 - b * b)}; }
inline dvec3 exit_point(const dvec3& p, const dvec3& d) { return p - 2.0 * glm::dot(p, d) * d; }

// What such a ray becomes, of an index of 1.5: energy and energy times mean vector.
inline Moments sphere_moments(double exponent, double b, int paths) {
    constexpr double ior = 1.5;
    std::mt19937_64 random(5);
    Moments sum;
    for (int i = 0; i < paths; ++i) {
        const dvec3 p = entry_point(b);
        dvec3 d(0.0, 0.0, -1.0);
        double weight = refract(d, p, ior, exponent, random) / paths;
        if (weight <= 0.0) continue;
        weight *= refract(d, -exit_point(p, d), 1.0 / ior, exponent, random);
        sum.energy += weight;
        sum.vector += weight * d;
    }
    return sum;
}

}  // namespace verglas::reference
