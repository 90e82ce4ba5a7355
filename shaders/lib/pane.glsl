// SPDX-License-Identifier: GPL-3.0-or-later
// A thin pane: two rough sides of a sheet of glass that moves no light aside. The bundle of each lobe meets the next
// side (the ENDF paper, section 4.3, has one lobe in its place). The including code provides what lobe_lookup.glsl needs.

struct Pane {
    // Slices of the lobe tables: of the glass from outside and from within; reflections are -1 without Fresnel.
    int entering;
    int leaving;
    int reflection_outside;
    int reflection_inside;
    float eta;  // of the glass to its surroundings
    float near_roughness;
    float far_roughness;
    bool inner_reflections;
};

// What comes to the viewer through a pane's near side.
struct PaneLobes {
    Moments transmitted;  // through both sides
    Moments trapped;      // the same, after reflections between them
    Moments reflected;    // by the far side
};

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
    for (int i = 0; i < BUNDLE_RAYS; ++i) {
        vec3 ray = bundle_ray(lobe, n, bundle_azimuth(i));
        Lobe kept = reflected_lobe(pane.reflection_inside, 1.0f / pane.eta, roughness, ray, n);
        moments = add_lobe(moments, kept, n, lobe.energy / float(BUNDLE_RAYS));
    }
    return lobe_from_moments(moments);
}

SHARED Moments scaled(Moments moments, float factor) {
    moments.energy *= factor;
    moments.vector *= factor;
    moments.second *= factor;
    return moments;
}

// d: unit direction of propagation from the viewer; n: unit normal that faces the viewer.
SHARED PaneLobes pane_lobes(Pane pane, vec3 d, vec3 n) {
    Lobe entered = refracted_lobe(pane.entering, pane.eta, pane.near_roughness, d, n, TIR_NONE);
    PaneLobes lobes;
    lobes.transmitted = left_through(pane, pane.far_roughness, entered, n);
    lobes.trapped = no_moments();
    lobes.reflected = no_moments();
    if (!pane.inner_reflections || pane.reflection_inside < 0) return lobes;
    Lobe back = kept_inside(pane, pane.far_roughness, entered, n);
    Lobe forth = kept_inside(pane, pane.near_roughness, back, -n);
    Lobe again = kept_inside(pane, pane.far_roughness, forth, n);
    float series = back.energy / max(back.energy - again.energy, 1e-6f);  // geometric, of all further rounds
    lobes.reflected = scaled(left_through(pane, pane.near_roughness, back, -n), series);
    lobes.trapped = scaled(left_through(pane, pane.far_roughness, forth, n), series);
    return lobes;
}
