// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes from the tables of lobe.glsl. The including code provides
//     vec4 sample_lobe_table(int table, float x, float y)
// with linear interpolation between nodes, x and y in 0 … 1.

SHARED float lobe_spread(vec4 node, float roughness) {
    float alpha = alpha_from_roughness(roughness);
    return clamp(exp2(node.y) * alpha * alpha, LOBE_MIN_SPREAD, 1.0f);
}

// Lobe of a table in the frame of an interface: d, unit direction of propagation from the viewer; n, unit
// normal that faces the viewer (d.n < 0); side: +1 for reflection, -1 for refraction, the sign of the lobe's
// own cosine to n. cos_theta may differ from -d.n (clamped rays).
SHARED Lobe lobe_from_table(int table, float cos_theta, float eta, float roughness, vec3 d, vec3 n, float side) {
    vec4 node = sample_lobe_table(table, lobe_table_x(cos_theta, eta), lobe_table_y(roughness));
    // Its length is the sine of d; a clamped ray's is that of the clamped cosine.
    vec3 tangent = d - dot(d, n) * n;
    float stretch = sqrt((1.0f - cos_theta * cos_theta) / max(dot(tangent, tangent), 1e-12f));
    Lobe lobe;
    lobe.energy = node.x;
    lobe.spread = lobe_spread(node, roughness);
    lobe.direction = normalize(node.z * stretch * tangent + side * node.w * n);
    return lobe;
}

SHARED Lobe reflected_lobe(int table, float eta, float roughness, vec3 d, vec3 n) {
    return lobe_from_table(table, clamp(-dot(d, n), 0.0f, 1.0f), eta, roughness, d, n, 1.0f);
}

// tir: TIR_NONE leaves what the rough interface still lets through; TIR_INCIDENT goes straight on, with the
// lobe of the critical angle; TIR_CLAMP refracts as at the critical angle (Wyman 2005).
SHARED float refracted_cosine(float eta, vec3 d, vec3 n, int tir) {
    float cos_theta = clamp(-dot(d, n), 0.0f, 1.0f);
    return tir == TIR_NONE ? cos_theta : max(cos_theta, critical_cosine(eta));
}

SHARED Lobe refracted_lobe(int table, float eta, float roughness, vec3 d, vec3 n, int tir) {
    float cos_theta = refracted_cosine(eta, d, n, tir);
    Lobe lobe = lobe_from_table(table, cos_theta, eta, roughness, d, n, -1.0f);
    if (tir == TIR_INCIDENT && cos_theta > clamp(-dot(d, n), 0.0f, 1.0f)) lobe.direction = d;
    return lobe;
}
