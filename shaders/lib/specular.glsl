// SPDX-License-Identifier: GPL-3.0-or-later
// A smooth interface in place of a rough one, for the baselines that refract sharply (Wyman 2005; Oliveira and
// Brauwers 2007): lobes without width. d: unit direction of propagation from the viewer; n: unit normal that faces
// the viewer; eta: n_behind / n_before; tir: TIR_*.

// Of the angle of incidence, above 0: interpolated normals may face away.
SHARED float incident_cosine(vec3 d, vec3 n) { return clamp(-dot(d, n), 1e-6f, 1.0f); }

// Refracted by Snell's law. Beyond the critical angle light leaves along the surface, or with TIR_INCIDENT goes
// straight on.
SHARED vec3 specular_direction(float eta, vec3 d, vec3 n, int tir) {
    float cos_theta = incident_cosine(d, n);
    float cos2_t = 1.0f - (1.0f - cos_theta * cos_theta) / (eta * eta);
    if (cos2_t < 0.0f && tir == TIR_INCIDENT) return d;
    return normalize(d / eta + (cos_theta / eta - sqrt(max(cos2_t, 0.0f))) * n);
}

// fresnel: whether its energy is 1 - F, which beyond the critical angle is 0 with every tir, as is that of rough lobes
// the more, the narrower they are. Else all is refracted, beyond the critical angle nothing with TIR_NONE.
SHARED Lobe specular_refraction(float eta, bool fresnel, vec3 d, vec3 n, int tir) {
    float cos_theta = incident_cosine(d, n);
    bool lost = tir == TIR_NONE && cos_theta < critical_cosine(eta);
    Lobe lobe;
    lobe.energy = fresnel ? 1.0f - fresnel_dielectric(cos_theta, eta) : lost ? 0.0f : 1.0f;
    lobe.spread = LOBE_MIN_SPREAD;
    lobe.direction = specular_direction(eta, d, n, tir);
    return lobe;
}

// With the energy F.
SHARED Lobe specular_reflection(float eta, vec3 d, vec3 n) {
    float cos_theta = incident_cosine(d, n);
    Lobe lobe;
    lobe.energy = fresnel_dielectric(cos_theta, eta);
    lobe.spread = LOBE_MIN_SPREAD;
    lobe.direction = normalize(d + 2.0f * cos_theta * n);
    return lobe;
}
