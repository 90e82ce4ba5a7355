// SPDX-License-Identifier: GPL-3.0-or-later
// Local lights (de Rousiers et al. 2012, section 5.2). From a point, a sphere of radiance L fills a cap of the sphere of
// directions. The paper takes a spherical Gaussian for it (eqs. 14, 15), which lobes narrower than the light see as a
// spot twice as bright, or as wide; here the share of a lobe in a cap is exact where they have the same axis.

// What a light is (LightKind of core/scene/scene.h).
const int LIGHT_SPHERE = 0;
const int LIGHT_DISK = 1;
const int LIGHT_SUN = 2;

struct LocalLight {
    int kind;
    vec3 place;  // of its centre; of a sun the unit direction toward it
    float radius;  // of a sun the half of its angle
    vec3 axis;
    vec3 intensity;
};

// A light as seen from a point.
struct LightCap {
    vec3 direction;  // unit, to its middle
    float versine;   // 1 - cos of its angular radius
    vec3 radiance;
};

// Points shine as spheres this small, in units of their distance: narrow lobes see them with an end.
const float LEAST_LIGHT_SINE = 1e-3f;

SHARED LightCap light_cap(LocalLight light, vec3 position) {
    LightCap cap;
    vec3 to_light = light.kind == LIGHT_SUN ? light.place : light.place - position;
    float squared_distance = max(dot(to_light, to_light), 1e-12f);
    cap.direction = to_light / sqrt(squared_distance);
    float sine = light.kind == LIGHT_SUN ? sin(min(light.radius, 0.5f * PI)) : light.radius / sqrt(squared_distance);
    sine = clamp(sine, LEAST_LIGHT_SINE, 1.0f);
    float cosine = sqrt(1.0f - sine * sine);
    cap.versine = sine * sine / (1.0f + cosine);
    float seen = light.kind == LIGHT_DISK ? max(-dot(light.axis, cap.direction), 0.0f) : 1.0f;
    // L = I / (pi r^2) = E / (pi sin^2), E = I / d^2.
    float shrink = light.kind == LIGHT_SUN ? 1.0f : 1.0f / squared_distance;
    cap.radiance = seen * shrink / (PI * sine * sine) * light.intensity;
    return cap;
}

// Distribution function of a normal variable (logistic approximation: Page 1977), error below 2e-4.
SHARED float normal_probability(float z) { return 1.0f / (1.0f + exp(-z * (1.5976f + 0.07056f * z * z))); }

// Share of a Gaussian of variance 1 in a disk of squared radius x whose middle is at the squared distance l: a
// non-central chi-squared distribution of two degrees of freedom (Sankaran 1963).
SHARED float disk_share(float x, float l) {
    float h = 1.0f - 2.0f / 3.0f * (2.0f + l) * (2.0f + 3.0f * l) / ((2.0f + 2.0f * l) * (2.0f + 2.0f * l));
    float p = (2.0f + 2.0f * l) / ((2.0f + l) * (2.0f + l));
    float m = (h - 1.0f) * (1.0f - 3.0f * h);
    float z = pow(x / (2.0f + l), h) - (1.0f + h * p * (h - 1.0f - 0.5f * (2.0f - h) * m * p));
    return normal_probability(z / (h * sqrt(2.0f * p) * (1.0f + 0.5f * m * p)));
}

// Share of a spherical Gaussian in a cap; versines, 1 - cos, of the cap's angular radius and of the angle between both
// axes. Small caps widen the Gaussian by their variance, a quarter of their squared radius; large ones have an edge.
SHARED float cap_share(float spread, float versine, float offset_versine) {
    float kappa = kappa_from_spread(clamp(spread, LOBE_MIN_SPREAD, 0.98f));
    float x = 2.0f * kappa * versine;
    float l = 2.0f * kappa * offset_versine;
    float on_axis = (1.0f - exp(-0.5f * x)) / (1.0f - exp(-2.0f * kappa));
    float small = exp(-0.5f * l / (1.0f + 0.25f * x));
    float t = clamp((x - 1.0f) / 3.0f, 0.0f, 1.0f);
    if (t <= 0.0f) return on_axis * small;
    float large = disk_share(x, l) / disk_share(x, 0.0f);
    return on_axis * mix(small, large, t * t * (3.0f - 2.0f * t));
}

// The lobes of rough glass are the more peaked than spherical Gaussians, the wider they are: two Gaussians of the same
// mean spread, a fifth of the energy in the wider one, stand for them. Measured on panes of roughness 0.6.
const float PEAK_TAIL_SHARE = 0.2f;

SHARED float peaked_cap_share(float spread, float versine, float offset_versine) {
    float q = min(sqrt(spread), 0.3f);
    float core = cap_share((1.0f - q) * spread, versine, offset_versine);
    float tail = cap_share(min((1.0f + 4.0f * q) * spread, 1.0f), versine, offset_versine);
    return mix(core, tail, PEAK_TAIL_SHARE);
}

// Radiance of a light under a lobe of energy 1 that leaves a surface. side: unit normal of the surface, to where the
// lobe leaves; light beyond its horizon doesn't count.
SHARED vec3 light_radiance(LocalLight light, vec3 position, vec3 direction, float spread, vec3 side) {
    LightCap cap = light_cap(light, position);
    float sine = sqrt(cap.versine * (2.0f - cap.versine));
    float above = clamp(0.5f + 0.5f * dot(cap.direction, side) / sine, 0.0f, 1.0f);
    vec3 between = direction - cap.direction;
    return above * peaked_cap_share(spread, cap.versine, 0.5f * dot(between, between)) * cap.radiance;
}
