// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes from the tables of lobe.glsl. The including code provides
//     vec4 sample_lobe_table(int table, float x, float y)
// with linear interpolation between nodes, x and y in 0 … 1.

SHARED PlanarLobe planar_lobe(int table, float cos_theta, float eta, float roughness) {
    vec4 node = sample_lobe_table(table, lobe_table_x(cos_theta, eta), lobe_table_y(roughness));
    float alpha = alpha_from_roughness(roughness);
    PlanarLobe lobe;
    lobe.energy = node.x;
    lobe.spread = clamp(exp2(node.y) * alpha * alpha, LOBE_MIN_SPREAD, 1.0f);
    lobe.along = node.z * sqrt(1.0f - cos_theta * cos_theta);
    lobe.away = node.w;
    return lobe;
}
