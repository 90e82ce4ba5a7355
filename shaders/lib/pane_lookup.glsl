// SPDX-License-Identifier: GPL-3.0-or-later
// The lobes of thin panes: the bundle of each lobe meets the next side (the ENDF paper, section 4.3, has one lobe in its
// place). The including code provides what lobe_lookup.glsl needs.

// What of a lobe inside the pane goes on behind a side. n: unit normal of the side, to where the lobe comes from.
SHARED Moments left_through(Pane pane, float roughness, Lobe lobe, vec3 n) {
    Moments moments = no_moments();
    for (int i = 0; i < BUNDLE_RAYS; ++i) {
        vec3 ray = bundle_ray(lobe, n, bundle_azimuth(i));
        Lobe out_lobe = refracted_lobe(pane.leaving, 1.0f / pane.eta, roughness, ray, n, TIR_NONE);
        moments = add_lobe(moments, out_lobe, -n, lobe.energy / float(BUNDLE_RAYS));
    }
    return moments;
}

// What of it stays inside.
SHARED Lobe kept_inside(Pane pane, float roughness, Lobe lobe, vec3 n) {
    Moments moments = no_moments();
    for (int i = 0; i < FAN_RAYS; ++i) {
        vec3 ray = fan_ray(lobe, n, i);
        Lobe kept = reflected_lobe(pane.reflection_inside, 1.0f / pane.eta, roughness, ray, n);
        moments = add_lobe(moments, kept, n, lobe.energy / float(FAN_RAYS));
    }
    return lobe_from_moments(moments);
}

// As left_through, as lobes side by side. factor: on the energy.
SHARED Fan fanned_out(Pane pane, float roughness, Lobe lobe, vec3 n, float factor) {
    Fan fan;
    float eta = 1.0f / pane.eta;
    for (int i = 0; i < FAN_RAYS; ++i) {
        vec3 ray = fan_ray(lobe, n, i);
        Lobe out_lobe = refracted_lobe(pane.leaving, eta, roughness, ray, n, TIR_NONE);
        out_lobe.energy *= factor * lobe.energy / float(FAN_RAYS);
        out_lobe.spread = warped_spread(FAN_LEFT * lobe.spread, out_lobe.spread, eta, abs(dot(ray, n)),
                                        abs(dot(out_lobe.direction, n)));
        fan.lobes[i] = out_lobe;
    }
    return fan;
}

// d: unit direction of propagation from the viewer; n: unit normal that faces the viewer.
SHARED PaneLobes pane_lobes(Pane pane, vec3 d, vec3 n) {
    Lobe entered = refracted_lobe(pane.entering, pane.eta, pane.near_roughness, d, n, TIR_NONE);
    PaneLobes lobes;
    lobes.transmitted = left_through(pane, pane.far_roughness, entered, n);
    for (int i = 0; i < FAN_RAYS; ++i) {
        lobes.trapped.lobes[i].energy = 0.0f;
        lobes.reflected.lobes[i].energy = 0.0f;
    }
    if (!pane.inner_reflections || pane.reflection_inside < 0) return lobes;
    Lobe back = kept_inside(pane, pane.far_roughness, entered, n);
    Lobe forth = kept_inside(pane, pane.near_roughness, back, -n);
    Lobe again = kept_inside(pane, pane.far_roughness, forth, n);
    float series = back.energy / max(back.energy - again.energy, 1e-6f);  // geometric, of all further rounds
    lobes.reflected = fanned_out(pane, pane.near_roughness, back, -n, series);
    lobes.trapped = fanned_out(pane, pane.far_roughness, forth, n, series);
    return lobes;
}
