// SPDX-License-Identifier: GPL-3.0-or-later
// The lobe tables' texture, a slice a layer; see core/passes/gpu_scene.h.
#include "lib/constants.glsl"
#include "lib/fresnel.glsl"
#include "lib/microfacet.glsl"
#include "lib/lobe.glsl"

uniform sampler2DArray lobe_tables;

vec4 sample_lobe_table(int table, float x, float y) {
    vec2 nodes = vec2(LOBE_COSINES, LOBE_ROUGHNESSES);
    return textureLod(lobe_tables, vec3((vec2(x, y) * (nodes - 1.0) + 0.5) / nodes, float(table)), 0.0);
}

#include "lib/lobe_lookup.glsl"
