// SPDX-License-Identifier: GPL-3.0-or-later
// A clear layer on an opaque base (the ENDF paper, section 5). Light that has entered meets the base and the layer's
// outer side in turn; the bundles of its lobes stand for it, as in a pane.

struct Coating {
    Pane outer;  // its near side is the layer's; the far one doesn't count
    float base_roughness;
    vec3 optical_depth;  // sigma_a times thickness
    vec3 base_color;     // reflectance at straight incidence, or albedo
    vec3 edge_tint;      // F82
    bool diffuse;
};

// Of lobes in the layer: wider ones leave it as a fan.
const float FANNED_SPREAD = 0.03f;

// Light that leaves the base, in the layer.
struct BaseLight {
    Lobe lobe;
    vec3 color;  // factor on its energy
};

// Schlick's reflectance, lowered so that at 82 degrees, where the cosine is 1/7, it is tint times his (Kutz, Hasan and
// Edmondson 2021).
SHARED vec3 tinted_reflectance(vec3 color, vec3 tint, float cos_theta) {
    float x = 1.0f - clamp(cos_theta, 0.0f, 1.0f);
    float at_82 = 6.0f / 7.0f;
    vec3 schlick = color + (vec3(1.0f) - color) * (x * x * x * x * x);
    vec3 schlick_82 = color + (vec3(1.0f) - color) * pow(at_82, 5.0f);
    vec3 a = schlick_82 * (vec3(1.0f) - tint) / (pow(at_82, 6.0f) / 7.0f);
    return max(schlick - a * ((1.0f - x) * pow(x, 6.0f)), vec3(0.0f));
}

// Normals are of vMF distributions over all of the sphere (the ENDF paper, eq. 6), of kappa = 2 / alpha^2: of rough ones
// many look down, and what meets these is lost. The formulas are fits to their integrals for kappa 1 ... 1000.

// Part of straight light that the facets of a mirror reflect upward, unhidden; within 0.02.
SHARED float unhidden(float alpha) { return 1.0f - exp(-0.32f * pow(2.0f / (alpha * alpha), 0.93f)); }

// What the facets of one side of the layer lose beside what the lobe tables do, whose normals all look up.
SHARED float overhang_factor(float roughness) {
    return pow(unhidden(max(alpha_from_roughness(roughness), 1e-4f)), 0.45f);
}

// Of what enters, which they lose the more at flat angles.
SHARED float entering_factor(float roughness, float cos_theta) {
    float lost = 1.0f - unhidden(max(alpha_from_roughness(roughness), 1e-4f));
    return overhang_factor(roughness) * mix(1.0f, 0.5f + 0.78f * cos_theta, lost / 0.726f);
}

// The lobe of light from one direction that a rough mirror reflects; energies within 0.08, spreads within a fifth.
SHARED Lobe rough_mirror(float alpha, vec3 d, vec3 n) {
    float x = alpha * alpha;
    float cos_theta = clamp(-dot(d, n), 1e-3f, 1.0f);
    float slant = 1.0f - cos_theta;
    Lobe lobe;
    float hidden = 0.19f * slant * slant / (1.0f + 0.02f / x);
    float seen = 0.5f * slant * exp(-0.4f / x);
    lobe.energy = min(unhidden(alpha) * (1.0f + seen - hidden), 1.0f);
    // Mean of the variances of both axes: a facet's tilt turns the light by twice as much in the plane of incidence,
    // and across it by that times the cosine (ENDF eq. 12 has the root of their product).
    float variance = x * (1.0f + cos_theta * cos_theta);
    float cut_off = 1.0f - 0.4f * slant * variance / (variance + 0.02f);
    const float widest = 0.354f;
    float e = exp(-2.0f * min(variance / widest, 10.0f));
    lobe.spread = max(cut_off * widest * (1.0f - e) / (1.0f + e), LOBE_MIN_SPREAD);
    lobe.direction = normalize(d + (2.0f * cos_theta + x * (4.75f - 3.75f * cos_theta)) * n);
    return lobe;
}

// Of a diffuse base: the mean cosine of its light is 2/3.
const float DIFFUSE_SPREAD = 1.0f / 3.0f;

SHARED Lobe base_reflection(Coating coating, Lobe down, vec3 n) {
    Lobe up = down;
    if (coating.diffuse) {
        up.direction = n;
        up.spread = DIFFUSE_SPREAD;
        return up;
    }
    float alpha = max(alpha_from_roughness(coating.base_roughness), 1e-4f);
    Moments moments = no_moments();
    for (int i = 0; i < FAN_RAYS; ++i) {
        Lobe mirrored = rough_mirror(alpha, fan_ray(down, n, i), n);
        mirrored.spread += FAN_LEFT * down.spread * (1.0f - mirrored.spread);
        moments = add_lobe(moments, mirrored, n, down.energy / float(FAN_RAYS));
    }
    return lobe_from_moments(moments);
}

// What the base and two ways through the layer leave of the light.
SHARED vec3 base_factor(Coating coating, float cos_down, float cos_up) {
    float way = 1.0f / max(cos_down, 0.05f) + 1.0f / max(cos_up, 0.05f);
    vec3 reflectance = coating.diffuse ? coating.base_color
                                       : tinted_reflectance(coating.base_color, coating.edge_tint, cos_down);
    return reflectance * exp(-way * coating.optical_depth);
}
