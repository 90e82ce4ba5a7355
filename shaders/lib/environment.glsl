// SPDX-License-Identifier: GPL-3.0-or-later
// Directions, levels and texels of the prefiltered environment (de Rousiers et al. 2012, section 4.1).
//
// Level l holds the map convolved with a normalised spherical Gaussian of concentration
// kappa_0 / ENVIRONMENT_LEVEL_RATIO^l. All levels lie above each other in one atlas. A level is an
// equirectangular lattice with rows ON both poles and a last column that repeats the first, so that bilinear
// interpolation is continuous everywhere.

const float ENVIRONMENT_LEVEL_RATIO = 2.0f;

// Equirectangular coordinates of a unit direction, as Blender's: u in 0 … 1, 1/2 along +X, falling toward +Y;
// v from 0 at -Z to 1 at +Z.
SHARED vec2 environment_uv(vec3 direction) {
    float azimuth = direction.x == 0.0f && direction.y == 0.0f ? 0.0f : atan(direction.y, direction.x);
    return vec2(0.5f - azimuth / (2.0f * PI), 1.0f - acos(clamp(direction.z, -1.0f, 1.0f)) / PI);
}

// Inverse of environment_uv.
SHARED vec3 environment_direction(vec2 uv) {
    float azimuth = (0.5f - uv.x) * 2.0f * PI;
    float theta = (1.0f - uv.y) * PI;
    return vec3(sin(theta) * cos(azimuth), sin(theta) * sin(azimuth), cos(theta));
}

// Position between levels for a lobe: the whole part is the level, the fraction weighs the next one. Between
// two levels radiance is interpolated linearly in spread, the variance of a narrow lobe, in which diffusion
// is linear to first order.
SHARED float environment_level(float spread, float kappa_0, float last_level) {
    float log_ratio = log2(ENVIRONMENT_LEVEL_RATIO);
    float level = clamp(log2(kappa_0 / kappa_from_spread(spread)) / log_ratio, 0.0f, last_level);
    float sharper = min(floor(level), last_level - 1.0f);
    float spread_0 = spread_from_kappa(kappa_0 * exp2(-log_ratio * sharper));
    float spread_1 = spread_from_kappa(kappa_0 * exp2(-log_ratio * (sharper + 1.0f)));
    return sharper + clamp((spread - spread_0) / (spread_1 - spread_0), 0.0f, 1.0f);
}
