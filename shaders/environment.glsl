// SPDX-License-Identifier: GPL-3.0-or-later
// The environment's textures; see core/passes/environment_filter.h.
#include "lib/constants.glsl"
#include "lib/spherical_gaussian.glsl"
#include "lib/environment.glsl"

const int MAX_ENVIRONMENT_LEVELS = 32;

uniform sampler2D environment_map;
uniform sampler2D environment_atlas;
// Columns, intervals between rows, first row, spread of the Gaussian.
uniform vec4 environment_levels[MAX_ENVIRONMENT_LEVELS];
uniform int environment_level_count;
uniform vec3 environment_color;      // factor on the map
uniform mat3 view_to_environment;    // camera space -> the map's frame

vec3 sample_environment_map(vec2 uv) { return textureLod(environment_map, uv, 0.0).rgb; }

vec3 sample_environment_level(int level, vec2 uv) {
    vec4 lattice = environment_levels[level];
    vec2 texel = vec2(uv.x * lattice.x, uv.y * lattice.y + lattice.z) + 0.5;
    return textureLod(environment_atlas, texel / vec2(textureSize(environment_atlas, 0)), 0.0).rgb;
}

float environment_spread(int level) { return environment_levels[level].w; }

int environment_last_level() { return environment_level_count - 1; }

#include "lib/environment_lookup.glsl"

vec2 environment_place(vec3 direction) { return environment_uv(view_to_environment * direction); }

// All light that arrives from outside under a lobe about a unit direction in camera space.
vec3 incoming_radiance(vec3 direction, float spread) {
    return environment_color * environment_radiance_at(environment_place(direction), spread);
}

// The sum under two lobes, most of which are wide. Software OpenGL takes half as long for these: it walks through both
// sides of a branch, but not through a loop that it doesn't enter.
vec3 incoming_wide_radiance(vec3 direction, vec3 other, float spread) {
    vec2 uv = environment_place(direction);
    vec2 other_uv = environment_place(other);
    float spread_0 = environment_spread(0);
    EnvironmentLevels levels = environment_levels_of(max(spread, spread_0));
    vec3 radiance = blurred_environment_at(uv, levels) + blurred_environment_at(other_uv, levels);
    int narrow = spread < spread_0 ? 1 : 0;
    for (int i = 0; i < narrow; ++i)
        radiance = mix(sample_environment_map(uv) + sample_environment_map(other_uv), radiance, spread / spread_0);
    return environment_color * radiance;
}
