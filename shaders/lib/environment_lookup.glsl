// SPDX-License-Identifier: GPL-3.0-or-later
// Radiance of the prefiltered environment. The including code provides, with u and v of environment_uv,
//     vec3 sample_environment_map(vec2 uv)
//     vec3 sample_environment_level(int level, vec2 uv)
//     float environment_kappa_0()
//     int environment_last_level()

// Mean radiance under a lobe of the given spread about a unit direction (in the map's frame).
SHARED vec3 environment_radiance(vec3 direction, float spread) {
    vec2 uv = environment_uv(direction);
    float spread_0 = spread_from_kappa(environment_kappa_0());
    if (spread < spread_0)
        return mix(sample_environment_map(uv), sample_environment_level(0, uv), spread / spread_0);
    float level = environment_level(spread, environment_kappa_0(), float(environment_last_level()));
    int sharper = min(int(level), environment_last_level() - 1);
    return mix(sample_environment_level(sharper, uv), sample_environment_level(sharper + 1, uv),
               level - float(sharper));
}
