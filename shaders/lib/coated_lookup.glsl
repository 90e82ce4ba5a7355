// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes of coatings from the tables of coated.glsl. The including code provides
//     vec4 sample_coating_row(float column, int row)
// with linear interpolation between nodes of a row, whose items lie side by side.

// Where a roughness is among nodes.
SHARED float coating_node(float roughness, float least, float greatest, int nodes) {
    if (nodes < 2) return 0.0f;
    float t = (coating_axis(roughness) - least) / max(greatest - least, 1e-6f);
    return clamp(t, 0.0f, 1.0f) * float(nodes - 1);
}

SHARED CoatingPlace coating_place(Coating coating, vec3 d, vec3 n) {
    CoatingTable table = coating.table;
    CoatingPlace place;
    place.n = n;
    vec3 tangent = d - dot(d, n) * n;
    if (dot(tangent, tangent) < 1e-8f)
        tangent = cross(n, abs(n.z) < 0.9f ? vec3(0.0f, 0.0f, 1.0f) : vec3(1.0f, 0.0f, 0.0f));
    place.tangent = normalize(tangent);
    place.side = cross(n, place.tangent);
    place.column = coating_column(-dot(d, n)) * float(COATING_ANGLES - 1);
    float base = coating_node(coating.base_roughness, table.base_least, table.base_greatest, table.base_nodes);
    float outer = coating_node(coating.outer_roughness, table.outer_least, table.outer_greatest, table.outer_nodes);
    int base_node = max(min(int(base), table.base_nodes - 2), 0);
    int outer_node = max(min(int(outer), table.outer_nodes - 2), 0);
    place.row = table.first_row + outer_node * table.base_nodes + base_node;
    place.base_share = base - float(base_node);
    place.outer_share = outer - float(outer_node);
    return place;
}

// Between the four rows about a place; one is enough where both roughnesses are uniform.
SHARED vec4 coating_item(CoatingTable table, CoatingPlace place, int item) {
    float column = float(item * COATING_ANGLES) + place.column;
    int base_rows = min(table.base_nodes, 2);
    int outer_rows = min(table.outer_nodes, 2);
    vec4 sum = vec4(0.0f);
    for (int outer = 0; outer < outer_rows; ++outer) {
        float outer_share = outer == 1 ? place.outer_share : 1.0f - place.outer_share;
        int row = place.row + outer * table.base_nodes;
        for (int base = 0; base < base_rows; ++base) {
            float share = base == 1 ? place.base_share : 1.0f - place.base_share;
            sum += outer_share * share * sample_coating_row(column, row + base);
        }
    }
    return sum;
}

SHARED CoatingLight coating_light(CoatingTable table, CoatingPlace place) {
    vec4 energies = coating_item(table, place, 0);
    vec4 means = coating_item(table, place, 1);
    CoatingLight light;
    light.energy = vec3(energies.x, energies.y, energies.z);
    light.ratio = energies.w;
    light.slant_5 = means.x;
    light.slant_6 = means.y;
    light.way = vec2(means.z, means.w);
    return light;
}

// A lobe in the frame of coated.glsl, whose direction is as good as unit.
SHARED Lobe coating_item_lobe(CoatingTable table, CoatingPlace place, int group, int part) {
    vec4 item = coating_item(table, place, 2 + group * COATING_PARTS + part);
    Lobe lobe;
    lobe.energy = 1.0f;
    lobe.spread = exp2(item.w);
    lobe.direction = vec3(item.x, item.y, item.z);
    return lobe;
}

// A part of a group on one side of the plane of incidence, in the frame of coated.glsl; its energy is that of a side,
// as a share of the group's. further: the share of light of the further bounces that is joined with the first one's;
// else 0.
SHARED Lobe coating_part(CoatingTable table, CoatingPlace place, int group, int part, float further) {
    Lobe first = coating_item_lobe(table, place, group, part);
    vec3 direction = normalize(first.direction);
    float spread = first.spread;
    if (further > 0.0f) {
        Lobe joined = joined_lobe(first, coating_item_lobe(table, place, COATING_FURTHER, part), further);
        direction = joined.direction;
        spread = joined.spread;
    }
    Lobe lobe;
    lobe.energy = 1.0f / float(coating_lobes(table, group));
    lobe.spread = clamp(spread, LOBE_MIN_SPREAD, 1.0f);
    lobe.direction = direction;
    return lobe;
}

// The same in the world, or where side is -1 its mirror image on the other side.
SHARED Lobe coating_lobe(CoatingPlace place, Lobe part, float side) {
    vec3 d = part.direction;
    Lobe lobe;
    lobe.energy = part.energy;
    lobe.spread = part.spread;
    lobe.direction = d.x * place.tangent + side * d.y * place.side + d.z * place.n;
    return lobe;
}
