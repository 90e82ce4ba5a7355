// SPDX-License-Identifier: GPL-3.0-or-later
// The bundle: four rays stand for the front lobe and are summed, after the back interface, as moments. Rays at
// the lobe's root-mean angle, cos theta_r = R1, with equal weights reproduce its mean vector exactly.

const int BUNDLE_RAYS = 4;

// Energy and mean vector (times energy), summed over rays.
struct Moments {
    float energy;
    vec3 vector;
};

// Ray i of the bundle of a lobe: a unit direction at cos = 1 - spread about the axis. n: the front normal,
// which fixes the azimuth; rays that would leave through the front interface are bent into its plane.
SHARED vec3 bundle_ray(Lobe lobe, vec3 n, int i) {
    vec3 side = cross(lobe.direction, n);
    float side_length = length(side);
    if (side_length < 1e-4f) {
        side = cross(lobe.direction, abs(n.z) < 0.9f ? vec3(0.0f, 0.0f, 1.0f) : vec3(1.0f, 0.0f, 0.0f));
        side_length = length(side);
    }
    side = side / side_length;
    vec3 up = cross(side, lobe.direction);
    // sin^2 = 1 - (1 - spread)^2. Azimuths of 45 degrees and on: pairs share the plane of incidence's sides.
    float offset = sqrt(0.5f * lobe.spread * (2.0f - lobe.spread));
    float a = (i & 1) == 0 ? offset : -offset;
    float b = (i & 2) == 0 ? offset : -offset;
    vec3 ray = (1.0f - lobe.spread) * lobe.direction + a * side + b * up;
    return normalize(ray - max(dot(ray, n) + 1e-3f, 0.0f) * n);
}

SHARED Moments no_moments() {
    Moments moments;
    moments.energy = 0.0f;
    moments.vector = vec3(0.0f);
    return moments;
}

// Adds a lobe with a weight.
SHARED Moments add_lobe(Moments moments, Lobe lobe, float weight) {
    float energy = weight * lobe.energy;
    moments.energy += energy;
    moments.vector += energy * (1.0f - lobe.spread) * lobe.direction;
    return moments;
}

// The lobe with these moments: direction m / |m|, R = |m| / W.
SHARED Lobe lobe_from_moments(Moments moments) {
    Lobe lobe;
    float vector_length = length(moments.vector);
    lobe.energy = moments.energy;
    lobe.spread = clamp(1.0f - vector_length / max(moments.energy, 1e-12f), LOBE_MIN_SPREAD, 1.0f);
    lobe.direction = vector_length > 0.0f ? moments.vector / vector_length : vec3(0.0f, 0.0f, 1.0f);
    return lobe;
}
