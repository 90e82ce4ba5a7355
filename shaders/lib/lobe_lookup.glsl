// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes of an interface in its place. The including code provides
//     PlanarLobe planar_lobe(int number, float cos_theta, float eta, float roughness)
// number: of a table (table_lobe.glsl) or of an analytic lobe (analytic_lobe.glsl).
// d: unit direction of propagation from the viewer; n: unit normal that faces the viewer (d.n < 0).

// side: +1 for reflection, -1 for refraction, the sign of the lobe's own cosine to n.
SHARED Lobe lobe_in_place(PlanarLobe planar, vec3 d, vec3 n, float side) {
    vec3 tangent = d - dot(d, n) * n;
    Lobe lobe;
    lobe.energy = planar.energy;
    lobe.spread = planar.spread;
    lobe.direction = normalize(planar.along / sqrt(max(dot(tangent, tangent), 1e-12f)) * tangent +
                               side * planar.away * n);
    return lobe;
}

SHARED Lobe reflected_lobe(int number, float eta, float roughness, vec3 d, vec3 n) {
    return lobe_in_place(planar_lobe(number, clamp(-dot(d, n), 0.0f, 1.0f), eta, roughness), d, n, 1.0f);
}

// tir: TIR_NONE leaves what the rough interface still lets through; TIR_INCIDENT goes straight on, with the
// lobe of the critical angle; TIR_CLAMP refracts as at the critical angle (Wyman 2005).
SHARED float refracted_cosine(float eta, vec3 d, vec3 n, int tir) {
    float cos_theta = clamp(-dot(d, n), 0.0f, 1.0f);
    return tir == TIR_NONE ? cos_theta : max(cos_theta, critical_cosine(eta));
}

SHARED Lobe refracted_lobe(int number, float eta, float roughness, vec3 d, vec3 n, int tir) {
    float cos_theta = refracted_cosine(eta, d, n, tir);
    Lobe lobe = lobe_in_place(planar_lobe(number, cos_theta, eta, roughness), d, n, -1.0f);
    if (tir == TIR_INCIDENT && cos_theta > clamp(-dot(d, n), 0.0f, 1.0f)) lobe.direction = d;
    return lobe;
}
