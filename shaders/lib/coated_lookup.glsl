// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes of coatings from the tables of coated.glsl. The including code provides
//     vec4 sample_coating_rows(float column, float row)
// with linear interpolation between nodes of all rows, whose items lie side by side.

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
    float base = clamp((coating_axis(coating.base_roughness) - table.base_least) /
                           max(table.base_greatest - table.base_least, 1e-6f), 0.0f, 1.0f) * float(table.base_nodes - 1);
    float outer = clamp((coating_axis(coating.outer_roughness) - table.outer_least) /
                            max(table.outer_greatest - table.outer_least, 1e-6f), 0.0f, 1.0f) *
                  float(table.outer_nodes - 1);
    float node = min(floor(outer), float(max(table.outer_nodes - 2, 0)));
    place.row = float(table.first_row) + node * float(table.base_nodes) + base;
    place.next_row = place.row + float(table.base_nodes);
    place.next_share = outer - node;
    return place;
}

SHARED vec4 coating_item(CoatingPlace place, int item) {
    float column = float(item * COATING_ANGLES) + place.column;
    vec4 value = sample_coating_rows(column, place.row);
    if (place.next_share <= 0.0f) return value;
    return mix(value, sample_coating_rows(column, place.next_row), place.next_share);
}

SHARED CoatingLight coating_light(CoatingPlace place) {
    vec4 energies = coating_item(place, 0);
    vec4 means = coating_item(place, 1);
    CoatingLight light;
    light.energy = vec3(energies.x, energies.y, energies.z);
    light.ratio = energies.w;
    light.slant_5 = means.x;
    light.slant_6 = means.y;
    light.way = vec2(means.z, means.w);
    return light;
}

SHARED bool is_divided(CoatingTable table, int group) { return ((table.divided >> group) & 1) != 0; }

// How many parts a group has; one that isn't divided is the first of them.
SHARED int coating_parts(CoatingTable table, int group) {
    if (!is_divided(table, group)) return 1;
    return group == COATING_FURTHER ? COATING_SLICES : COATING_PARTS;
}

SHARED vec4 coating_part(CoatingPlace place, int group, int part) {
    return coating_item(place, 2 + group * COATING_PARTS + part);
}

// The lobe of a part to one side of the plane of incidence, +1 or -1; its energy is its share of the group's.
SHARED Lobe coating_lobe(CoatingTable table, CoatingPlace place, int group, vec4 part, float side) {
    Lobe lobe;
    lobe.energy = is_divided(table, group) ? 0.5f / float(coating_parts(table, group)) : 1.0f;
    lobe.spread = clamp(exp2(part.w), LOBE_MIN_SPREAD, 1.0f);
    lobe.direction = normalize(part.x * place.tangent + side * part.y * place.side + part.z * place.n);
    return lobe;
}
