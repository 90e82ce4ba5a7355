// SPDX-License-Identifier: GPL-3.0-or-later
// A thin pane: two rough sides of a sheet of glass that moves no light aside.

struct Pane {
    // Numbers of lobes (lobe_lookup.glsl): of the glass from outside and from within; reflections are -1 without
    // Fresnel.
    int entering;
    int leaving;
    int reflection_outside;
    int reflection_inside;
    float eta;  // of the glass to its surroundings
    float near_roughness;
    float far_roughness;
    bool inner_reflections;
};

// Light that is reflected between the sides is soon spread wide, and whether it leaves changes at the critical angle
// at once: two rings of rays stand for it, each ray with a part of its variance.
const int FAN_RINGS = 2;
const int FAN_RAYS = FAN_RINGS * BUNDLE_RAYS;
const float FAN_LEFT = 0.3f;

// Lobes side by side.
struct Fan {
    Lobe lobes[FAN_RAYS];
};

// A ray of a lobe's fan. n: as for bundle_ray.
SHARED vec3 fan_ray(Lobe lobe, vec3 n, int i) {
    Lobe ring = lobe;
    ring.spread = min((1.0f - FAN_LEFT) * (i < BUNDLE_RAYS ? 0.3f : 1.7f) * lobe.spread, 1.0f);
    return bundle_ray(ring, n, bundle_azimuth(i));
}

// What comes to the viewer through a pane's near side.
struct PaneLobes {
    Moments transmitted;  // through both sides
    Fan trapped;          // the same, after reflections between them
    Fan reflected;        // by the far side
};
