// SPDX-License-Identifier: GPL-3.0-or-later
// The bundle: four rays stand for the front lobe and are summed, after the back interface, as moments. Rays at
// the lobe's root-mean angle, cos theta_r = R1, with equal weights reproduce its mean vector exactly.

const int BUNDLE_RAYS = 4;

// Summed over rays: energy, mean vector times energy, and the part of the second moments that differs with the
// azimuth about the mean.
struct Moments {
    float energy;
    vec3 vector;
    mat3 second;
};

// A lobe that is wider along one axis: EXIT_TAPS isotropic lobes of equal energy, side by side.
struct WideLobe {
    vec3 direction;
    float spread;  // of each
    vec3 axis;     // from one to the next
};

const int EXIT_TAPS = 3;

// Azimuth of ray i about the axis, as (cos, sin): 45 degrees and on, so that pairs share the sides of the plane of
// incidence.
SHARED vec2 bundle_azimuth(int i) {
    const float diagonal = 0.70710678f;
    return vec2((i & 1) == 0 ? diagonal : -diagonal, (i & 2) == 0 ? diagonal : -diagonal);
}

// A ray of the bundle of a lobe: a unit direction at cos = 1 - spread about the axis. n: the front normal, from which
// azimuths count; rays that would leave through the front interface are bent into its plane.
SHARED vec3 bundle_ray(Lobe lobe, vec3 n, vec2 azimuth) {
    vec3 side = cross(lobe.direction, n);
    float side_length = length(side);
    if (side_length < 1e-4f) {
        side = cross(lobe.direction, abs(n.z) < 0.9f ? vec3(0.0f, 0.0f, 1.0f) : vec3(1.0f, 0.0f, 0.0f));
        side_length = length(side);
    }
    side = side / side_length;
    vec3 up = cross(side, lobe.direction);
    float sine = sqrt(lobe.spread * (2.0f - lobe.spread));  // sin^2 = 1 - (1 - spread)^2
    vec3 ray = (1.0f - lobe.spread) * lobe.direction + sine * azimuth.x * side + sine * azimuth.y * up;
    return normalize(ray - max(dot(ray, n) + 1e-3f, 0.0f) * n);
}

SHARED Moments no_moments() {
    Moments moments;
    moments.energy = 0.0f;
    moments.vector = vec3(0.0f);
    moments.second = mat3(0.0f);
    return moments;
}

// A facet that tilts by a small angle turns the refracted ray 1 / cos theta_t times as far in the plane of incidence as
// across it (Snell's law, differentiated), so of a narrow lobe's variances, whose mean is its spread, one is
// 1 / cos^2 theta_t of the other. Wide lobes are cut off at the horizon and are rounder; how fast they become so was
// fitted to path-traced spheres and lenses of roughness 0.25 and 0.55 under three environment maps.
const float HORIZON_ROUNDING = 80.0f;

// Variance in the plane of incidence less that across it, of a lobe that leaves at cos_theta_t; per sin^2 theta_t.
SHARED float exit_excess(float spread, float cos_theta_t) {
    return 2.0f * spread / (1.0f + cos_theta_t * cos_theta_t + HORIZON_ROUNDING * spread);
}

// Adds a lobe that leaves through an interface with unit normal n, with a weight.
SHARED Moments add_lobe(Moments moments, Lobe lobe, vec3 n, float weight) {
    float energy = weight * lobe.energy;
    vec3 vector = energy * (1.0f - lobe.spread) * lobe.direction;
    moments.energy += energy;
    moments.vector += vector;
    moments.second += outerProduct(vector, lobe.direction);
    float cos_theta_t = dot(n, lobe.direction);
    vec3 in_plane = n - cos_theta_t * lobe.direction;  // its length is sin theta_t
    moments.second += energy * exit_excess(lobe.spread, cos_theta_t) * outerProduct(in_plane, in_plane);
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

// A lobe of the given mean variance (spread), and with so much more (excess) along one unit axis than across it. Lobes
// in a row vary by (EXIT_TAPS^2 - 1) / 12 of their squared distance, which two standard deviations bound.
SHARED WideLobe widened(vec3 direction, float spread, float excess, vec3 axis) {
    const float row_variance = float(EXIT_TAPS * EXIT_TAPS - 1) / 12.0f;
    float bounded = min(excess, spread * 4.0f * row_variance / (1.0f + 2.0f * row_variance));
    WideLobe lobe;
    lobe.direction = direction;
    lobe.spread = max(spread - 0.5f * bounded, LOBE_MIN_SPREAD);
    lobe.axis = sqrt(bounded / row_variance) * axis;
    return lobe;
}

// The lobe with these moments, and the axis along which they are widest.
SHARED WideLobe wide_lobe_from_moments(Moments moments) {
    Lobe mean = lobe_from_moments(moments);
    vec3 side = normalize(
        cross(mean.direction, abs(mean.direction.z) < 0.9f ? vec3(0.0f, 0.0f, 1.0f) : vec3(1.0f, 0.0f, 0.0f)));
    vec3 up = cross(side, mean.direction);
    // Eigenvalues of the 2 x 2 covariance across the direction: their difference, and the greater one's axis.
    vec3 along_side = moments.second * side / max(moments.energy, 1e-12f);
    vec3 along_up = moments.second * up / max(moments.energy, 1e-12f);
    float half_difference = 0.5f * (dot(side, along_side) - dot(up, along_up));
    float covariance = dot(up, along_side);
    float excess = 2.0f * sqrt(half_difference * half_difference + covariance * covariance);
    float azimuth = excess > 0.0f ? 0.5f * atan(covariance, half_difference) : 0.0f;
    return widened(mean.direction, mean.spread, excess, cos(azimuth) * side + sin(azimuth) * up);
}

// A single lobe that leaves through an interface with unit normal n.
SHARED WideLobe wide_lobe(vec3 direction, float spread, vec3 n) {
    float cos_theta_t = dot(n, direction);
    vec3 in_plane = n - cos_theta_t * direction;
    float sin2_theta_t = dot(in_plane, in_plane);
    return widened(direction, spread, exit_excess(spread, cos_theta_t) * sin2_theta_t,
                   in_plane / sqrt(max(sin2_theta_t, 1e-12f)));
}

// Direction of lobe i of a wide lobe.
SHARED vec3 tap_direction(WideLobe lobe, int i) {
    return normalize(lobe.direction + (float(i) - 0.5f * float(EXIT_TAPS - 1)) * lobe.axis);
}

// GGX's facets tilt far more often than Gaussian ones of the same mean, and most of them less: one Gaussian is too wide
// in its middle and too narrow at its foot. Two, a core and a tail, are closer; their mean spread is the lobe's. The
// tail's share of the energy and its width, in units of the lobe's, were measured on path-traced spheres and monkeys of
// roughness 0.25 and 0.55, where they are flat.
const float TAIL_SHARE = 0.2f;
const float TAIL_WIDTH = 3.5f;
const float CORE_WIDTH = (1.0f - TAIL_SHARE * TAIL_WIDTH) / (1.0f - TAIL_SHARE);

// Spread of a lobe that is so many times as wide.
SHARED float widened_spread(float spread, float width) { return clamp(width * spread, LOBE_MIN_SPREAD, 1.0f); }

// Of light: by it is told whether rays that bring it are followed.
SHARED float greatest(vec3 light) { return max(max(light.x, light.y), light.z); }

// Light that is followed no further inside the glass leaves it after more interfaces, wherever to: it is taken from
// nearly everywhere, less what these keep. Both measured on path-traced spheres, monkeys, bottles and gems of roughness
// 0.25 and 0.55, where they are flat.
const float CUT_SPREAD = 0.8f;
const float CUT_SHARE = 0.7f;
