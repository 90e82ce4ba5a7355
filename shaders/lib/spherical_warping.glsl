// SPDX-License-Identifier: GPL-3.0-or-later
// Joint spherical warping (the ENDF paper, section 4): what becomes of a beam, whose directions o have a von
// Mises-Fisher distribution, at facets whose normals m have one about n. Without Fresnel's factor and masking.
// eta: n_behind / n_before; cosines to n of the mean directions before and behind, above 0.

// Spread of the spherical convolution of two distributions: A3(kappa) = A3(a) A3(b), by 1 - A3 so that sharp ones keep
// their precision.
SHARED float convolved_spread(float a, float b) { return a + b - a * b; }

SHARED float convolved_kappa(float a, float b) {
    return kappa_from_spread(convolved_spread(spread_from_kappa(a), spread_from_kappa(b)));
}

// The paper's way: concentrations are multiplied by a warp's Jacobian, as here of what was before it by what is behind.
// Where it stretches one axis more than the other, this is the root of the product of both variances, less than their
// mean.

// d(m) / d(t) of a refraction (eq. 13); of a reflection it is 1 / (4 cos_o) (eq. 12).
SHARED float facet_jacobian(float eta, float cos_o, float cos_t) {
    float denominator = cos_o - eta * cos_t;
    return eta * eta * cos_t / max(denominator * denominator, 1e-12f);
}

// d(o) / d(t) of a refraction (eq. 21); of a reflection it is 1.
SHARED float beam_jacobian(float eta, float cos_o, float cos_t) { return eta * eta * cos_t / max(cos_o, 1e-4f); }

// Concentration of a beam that has been reflected (eq. 18).
SHARED float reflected_kappa(float kappa_o, float kappa_m, float cos_o) {
    return convolved_kappa(kappa_m / (4.0f * cos_o), kappa_o);
}

// The same of one that has been refracted (eq. 21).
SHARED float refracted_kappa(float kappa_o, float kappa_m, float eta, float cos_o, float cos_t) {
    return convolved_kappa(facet_jacobian(eta, cos_o, cos_t) * kappa_m, beam_jacobian(eta, cos_o, cos_t) * kappa_o);
}

// As spreads, where that of a ray behind the interface is known: `own`.
SHARED float warped_spread(float incident, float own, float eta, float cos_o, float cos_t) {
    float beam = spread_from_kappa(beam_jacobian(eta, cos_o, cos_t) * kappa_from_spread(incident));
    return convolved_spread(beam, own);
}

// By moments: the mean vector of what leaves. Facets that face away from o count, too, though they turn nothing: of
// wide distributions at flat angles they matter. A beam has directions of propagation, its mean is d = -o; n faces it.
// Energies stay as they are.

// Mean square of a normal's part along either axis across n; along n it is 1 less twice that.
SHARED float normal_variance(float kappa_m) { return (1.0f - spread_from_kappa(kappa_m)) / kappa_m; }

// r = 2 (m.o) m - o, of which E[r] = (2 E[m m^T] - 1) E[o]: exact.
SHARED Lobe reflected_beam(Lobe beam, float kappa_m, vec3 n) {
    float s = normal_variance(kappa_m);
    float c = dot(beam.direction, n);
    Lobe reflected = beam;
    reflected.direction = normalize((1.0f - 2.0f * s) * beam.direction - (2.0f - 6.0f * s) * c * n);
    // 1 - |E[r]| of a ray, by 1 - |E[r]|^2.
    float lost = 4.0f * s * (1.0f - s + (1.0f - 3.0f * s) * c * c);
    float own = lost / (1.0f + sqrt(max(1.0f - lost, 0.0f)));
    reflected.spread = convolved_spread(own, beam.spread);
    return reflected;
}

// t = f(o.m) m - o / eta, f(c) = c / eta - cos_t. The mean of a function of m over a narrow distribution is what it is
// at n and half of the variance on either axis times its Laplacian on the sphere there; and so for o. To first order in
// the variances s_m and s_o these add to t
//     s_m / 2 (((1 - c^2) f'' - 4 c f' - 2 f) n + 2 f' o),
//     s_o / 2 (((1 - c^2) f'' - 2 c f') n + 2 o / eta).
// What of this goes against t is what |E[t]| loses; the rest turns it. Within the critical angle, far from it.
SHARED Lobe refracted_beam(Lobe beam, float eta, float kappa_m, vec3 n) {
    vec3 d = beam.direction;
    float c = -dot(d, n);
    float sin2 = 1.0f - c * c;
    float cos_t = sqrt(max(1.0f - sin2 / (eta * eta), 1e-4f));
    float f = c / eta - cos_t;
    float df = 1.0f / eta - c / (eta * eta * cos_t);
    float ddf = (1.0f - eta * eta) / (eta * eta * eta * eta * cos_t * cos_t * cos_t);
    vec3 t = f * n + d / eta;
    vec3 by_m = normal_variance(kappa_m) * (0.5f * (sin2 * ddf - 4.0f * c * df - 2.0f * f) * n - df * d);
    vec3 by_o = beam.spread * (0.5f * (sin2 * ddf - 2.0f * c * df) * n - d / eta);
    Lobe refracted = beam;
    refracted.direction = normalize(t + by_m + by_o);
    refracted.spread = convolved_spread(min(-dot(t, by_m), 1.0f), min(-dot(t, by_o), 1.0f));
    return refracted;
}
