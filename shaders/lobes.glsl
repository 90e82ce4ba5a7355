// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes of the materials' interfaces by their numbers (Material.tables): from the tables' texture, a slice a layer (see
// core/passes/gpu_scene.h), or where ANALYTIC_LOBES is defined in closed form.
#include "lib/constants.glsl"
#include "lib/fresnel.glsl"
#include "lib/microfacet.glsl"
#include "lib/spherical_gaussian.glsl"
#include "lib/lobe.glsl"
#include "lib/spherical_warping.glsl"

#ifdef ANALYTIC_LOBES
#include "lib/analytic_lobe.glsl"

PlanarLobe planar_lobe(int kind, float cos_theta, float eta, float roughness) {
    return analytic_lobe(kind, cos_theta, eta, roughness);
}
#else
uniform sampler2DArray lobe_tables;

vec4 sample_lobe_table(int table, float x, float y) {
    vec2 nodes = vec2(LOBE_COSINES, LOBE_ROUGHNESSES);
    return textureLod(lobe_tables, vec3((vec2(x, y) * (nodes - 1.0) + 0.5) / nodes, float(table)), 0.0);
}

#include "lib/table_lobe.glsl"
#endif

#include "lib/lobe_lookup.glsl"
