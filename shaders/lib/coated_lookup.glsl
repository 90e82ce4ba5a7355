// SPDX-License-Identifier: GPL-3.0-or-later
// Coatings by the lobes of their outer side. The including code provides what lobe_lookup.glsl needs.

// A lobe in the layer that goes down, after the base.
SHARED BaseLight after_base(Coating coating, Lobe down, vec3 color, vec3 n) {
    BaseLight light;
    light.lobe = base_reflection(coating, down, n);
    light.color = color * base_factor(coating, -dot(down.direction, n), dot(light.lobe.direction, n));
    return light;
}

// Light of the first bounce. d: unit direction of propagation from the viewer; n: unit normal that faces the viewer.
SHARED BaseLight first_bounce(Coating coating, vec3 d, vec3 n) {
    Pane outer = coating.outer;
    Lobe entered = refracted_lobe(outer.entering, outer.eta, outer.near_roughness, d, n, TIR_NONE);
    entered.energy *= entering_factor(outer.near_roughness, clamp(-dot(d, n), 0.0f, 1.0f));
    return after_base(coating, entered, vec3(1.0f), n);
}

// The share of a wide lobe in the layer that leaves it: what lies within the critical angle, less what is reflected at
// straight incidence. Few rays see too little of such an edge. Facets turn light to the edge and from it; that lobes of
// the base are flatter than spherical Gaussians was measured for kappa 1, 10 and 30; for a diffuse one it is exact at an
// eta of 1.5.
SHARED float share_within_critical_angle(Coating coating, Lobe up, vec3 n) {
    float eta = coating.outer.eta;
    float alpha = alpha_from_roughness(coating.outer.near_roughness);
    float straight = (eta - 1.0f) / (eta + 1.0f);
    return (1.0f - straight * straight) * cap_share(up.spread + 0.5f * alpha * alpha,
                                                    1.0f - critical_cosine(1.0f / eta), 1.0f - dot(up.direction, n));
}

// The same of light from the base.
SHARED float share_of_base_light(Coating coating, Lobe up, vec3 n) {
    up.spread *= coating.diffuse ? 1.34f : 1.2f;
    return share_within_critical_angle(coating, up, n);
}

// How far that counts in place of the tables: for wide lobes, under a side that is not rough itself.
SHARED float edge_weight(Coating coating, Lobe up) {
    float alpha = alpha_from_roughness(coating.outer.near_roughness);
    return clamp((up.spread - 0.01f) / 0.07f, 0.0f, 1.0f) * clamp(1.5f - 2.0f * alpha, 0.0f, 1.0f);
}

// What of the light leaves the layer. Narrow lobes stay together.
SHARED Moments leaving_lobe(Coating coating, BaseLight light, vec3 n) {
    float roughness = coating.outer.near_roughness;
    Lobe up = light.lobe;
    up.energy *= overhang_factor(roughness);
    return left_through(coating.outer, roughness, up, -n);
}

SHARED Fan leaving_light(Coating coating, BaseLight light, vec3 n) {
    float roughness = coating.outer.near_roughness;
    Fan fan = fanned_out(coating.outer, roughness, light.lobe, -n, overhang_factor(roughness));
    float t = edge_weight(coating, light.lobe);
    if (t <= 0.0f) return fan;
    float shares[FAN_RAYS];
    float sum = 0.0f;
    for (int i = 0; i < FAN_RAYS; ++i) {
        Lobe ray = light.lobe;
        ray.direction = fan_ray(light.lobe, -n, i);
        ray.spread *= FAN_LEFT;
        shares[i] = share_within_critical_angle(coating, ray, n);
        sum += shares[i];
    }
    float energy = light.lobe.energy * overhang_factor(roughness) * share_of_base_light(coating, light.lobe, n);
    for (int i = 0; i < FAN_RAYS; ++i)
        fan.lobes[i].energy = mix(fan.lobes[i].energy, energy * shares[i] / max(sum, 1e-6f), t);
    return fan;
}

// Light of the next bounce, by what the outer side keeps inside.
SHARED BaseLight next_bounce(Coating coating, BaseLight light, vec3 n) {
    float roughness = coating.outer.near_roughness;
    Lobe down = kept_inside(coating.outer, roughness, light.lobe, -n);
    float t = edge_weight(coating, light.lobe);
    float kept = light.lobe.energy * (1.0f - share_of_base_light(coating, light.lobe, n));
    down.energy = overhang_factor(roughness) * mix(down.energy, kept, t);
    return after_base(coating, down, light.color, n);
}
