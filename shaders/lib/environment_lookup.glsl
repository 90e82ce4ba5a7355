// SPDX-License-Identifier: GPL-3.0-or-later
// Radiance of the prefiltered environment. The including code provides, with u and v of environment_uv,
//     vec3 sample_environment_map(vec2 uv)
//     vec3 sample_environment_level(int level, vec2 uv)
//     float environment_spread(int level)    // of its Gaussian; at least two levels
//     int environment_last_level()

// The level whose Gaussian is the widest that isn't wider than the lobe; never the last one. Spreads of narrow
// Gaussians grow by ENVIRONMENT_LEVEL_RATIO from level to level, those of wide ones by less.
SHARED int sharper_level(float spread) {
    int last = environment_last_level() - 1;
    int level = min(int(log2(spread / environment_spread(0)) / log2(ENVIRONMENT_LEVEL_RATIO)), last);
    while (level < last && environment_spread(level + 1) <= spread) ++level;
    return level;
}

// Between the levels next to a lobe that is not narrower than the first one's Gaussian. Interpolation is linear in
// spread, the variance of a narrow lobe, in which diffusion is linear to first order.
struct EnvironmentLevels {
    int sharper;
    float share;  // of the next one
};

SHARED EnvironmentLevels environment_levels_of(float spread) {
    EnvironmentLevels at;
    at.sharper = sharper_level(spread);
    float sharper = environment_spread(at.sharper);
    at.share = clamp((spread - sharper) / (environment_spread(at.sharper + 1) - sharper), 0.0f, 1.0f);
    return at;
}

// Mean radiance about a place of environment_uv.
SHARED vec3 blurred_environment_at(vec2 uv, EnvironmentLevels at) {
    return mix(sample_environment_level(at.sharper, uv), sample_environment_level(at.sharper + 1, uv), at.share);
}

// Mean radiance under any lobe.
SHARED vec3 environment_radiance_at(vec2 uv, float spread) {
    float spread_0 = environment_spread(0);
    if (spread < spread_0)
        return mix(sample_environment_map(uv), sample_environment_level(0, uv), spread / spread_0);
    return blurred_environment_at(uv, environment_levels_of(spread));
}

// The same about a unit direction in the map's frame.
SHARED vec3 environment_radiance(vec3 direction, float spread) {
    return environment_radiance_at(environment_uv(direction), spread);
}
