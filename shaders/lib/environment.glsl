// SPDX-License-Identifier: GPL-3.0-or-later
// Directions, levels and texels of the prefiltered environment (de Rousiers et al. 2012, section 4.1).
//
// Level l holds the map convolved with a normalised spherical Gaussian of concentration
// kappa_0 / ENVIRONMENT_LEVEL_RATIO^l. All levels lie above each other in one atlas. A level is an
// equirectangular lattice with rows ON both poles and a last column that repeats the first, so that bilinear
// interpolation is continuous everywhere.

const float ENVIRONMENT_LEVEL_RATIO = 2.0f;

// Angle of the point (x, y) from the x axis, 0 … PI for y >= 0, and 0 for (0, 0). The odd polynomial is the minimax
// approximation of atan on 0 … 1, within 3e-7: GLSL leaves the precision of its own functions open, and C++'s take
// most of the time of a lookup.
SHARED float angle_from_axis(float x, float y) {
    float longer = max(abs(x), y);
    float t = min(abs(x), y) / max(longer, 1e-30f);
    float s = t * t;
    float angle = 0.006811784f;
    angle = angle * s - 0.033604193f;
    angle = angle * s + 0.079623642f;
    angle = angle * s - 0.132333404f;
    angle = angle * s + 0.198078151f;
    angle = angle * s - 0.333173680f;
    angle = (angle * s + 0.999996112f) * t;
    if (abs(x) < y) angle = 0.5f * PI - angle;
    return x < 0.0f ? PI - angle : angle;
}

// Equirectangular coordinates of a direction of any length, as Blender's: u in 0 … 1, 1/2 along +X, falling toward +Y;
// v from 0 at -Z to 1 at +Z.
SHARED vec2 environment_uv(vec3 direction) {
    float azimuth = angle_from_axis(direction.x, abs(direction.y));
    float sine = sqrt(direction.x * direction.x + direction.y * direction.y);
    return vec2(0.5f - (direction.y < 0.0f ? -azimuth : azimuth) * (0.5f / PI),
                1.0f - angle_from_axis(direction.z, sine) * (1.0f / PI));
}

// Inverse of environment_uv.
SHARED vec3 environment_direction(vec2 uv) {
    float azimuth = (0.5f - uv.x) * 2.0f * PI;
    float theta = (1.0f - uv.y) * PI;
    return vec3(sin(theta) * cos(azimuth), sin(theta) * sin(azimuth), cos(theta));
}
