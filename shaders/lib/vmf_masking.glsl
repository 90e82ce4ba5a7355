// SPDX-License-Identifier: GPL-3.0-or-later
// Masking by facets whose normals have the von Mises-Fisher distribution M(m; n, kappa) (the ENDF paper, section 3).
// cos_theta: of a direction o to n, 0 … 1.

// The area of facets that look toward o: the integral of <o,m> M(m; n, kappa), for which the paper has eq. 8. The mean
// A3 cos and the variance of o.m are known; were it distributed normally, the integral would be
//     mean Phi(z) + deviation phi(z), z = mean / deviation.
// The factor on the last term is sqrt(3 pi / 8) for kappa = 0, where o.m is distributed evenly over -1 ... 1; that it
// vanishes with kappa, and its part with cos^2, for the skewness, are fits. Within 0.008 for any kappa, and
// G1 = A3 cos / area within 0.01.
SHARED float approximate_facing_area(float kappa, float cos_theta) {
    float A3 = 1.0f - spread_from_kappa(kappa);
    float cos2 = min(cos_theta * cos_theta, 1.0f);  // of unit vectors it may be more by rounding
    float across = A3 / kappa;
    float along = max(1.0f - 2.0f * across - A3 * A3, 0.0f);
    float deviation = sqrt((1.0f - cos2) * across + cos2 * along);
    float mean = A3 * cos_theta;
    float z = mean / max(deviation, 1e-12f);
    if (z > 6.0f) return mean;
    float density = exp(-0.5f * z * z) / sqrt(2.0f * PI);
    float factor = 1.0f + 0.0854f / (1.0f + kappa / 3.0f) + 2.0f / 3.0f * A3 * A3 * cos2;
    return mean * normal_probability(z) + factor * deviation * density;
}
