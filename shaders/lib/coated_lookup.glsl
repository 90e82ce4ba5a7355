// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes of coatings from the tables of coated.glsl. The including code provides
//     vec4 sample_coating_row(float column, int row)
// with linear interpolation between nodes of a row, whose items lie side by side.

// Where a roughness is among nodes.
SHARED float coating_node(float roughness, float least, float greatest, int nodes) {
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
    int corners = base_rows * min(table.outer_nodes, 2);
    vec4 sum = vec4(0.0f);
    for (int i = 0; i < corners; ++i) {
        int next_base = i % base_rows;
        int next_outer = i / base_rows;
        float share = (next_base == 1 ? place.base_share : 1.0f - place.base_share) *
                      (next_outer == 1 ? place.outer_share : 1.0f - place.outer_share);
        sum += share * sample_coating_row(column, place.row + next_outer * table.base_nodes + next_base);
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

SHARED vec4 coating_part(CoatingTable table, CoatingPlace place, int group, int part) {
    return coating_item(table, place, 2 + group * COATING_PARTS + part);
}

// Two lobes of energies 1 - share and share as one, by their mean vectors, whose lengths are 1 - spread. With D between
// both directions, |mean|^2 = A^2 - share (1 - share) a b D^2, where A is the mean of a = 1 - spread and b = 1 - spread'.
SHARED Lobe joined_lobe(Lobe lobe, Lobe other, float share) {
    vec3 between = other.direction - lobe.direction;
    float a = 1.0f - lobe.spread;
    float b = 1.0f - other.spread;
    float mean = mix(a, b, share);
    float apart = clamp(share * (1.0f - share) * a * b * dot(between, between) / max(mean * mean, 1e-6f), 0.0f, 1.0f);
    lobe.spread = mix(lobe.spread, other.spread, share) + mean * apart / (1.0f + sqrt(1.0f - apart));
    lobe.direction = normalize((1.0f - share) * a * lobe.direction + share * b * other.direction);
    return lobe;
}

// The lobe of a part as coating_part has it, to one side of the plane of incidence, +1 or -1.
SHARED Lobe coating_lobe_of(CoatingPlace place, vec4 part, float side) {
    Lobe lobe;
    lobe.energy = 0.0f;
    lobe.spread = clamp(exp2(part.w), LOBE_MIN_SPREAD, 1.0f);
    lobe.direction = normalize(part.x * place.tangent + side * part.y * place.side + part.z * place.n);
    return lobe;
}

// A lobe of a group, whose energy is its share of the group's: that of part i / 2 to one side of the plane of incidence
// where i is even, or to the other; or of the whole, which is only 0. further: the share of light of the further bounces
// that is joined with the first one's; else 0.
SHARED Lobe coating_lobe(CoatingTable table, CoatingPlace place, int group, int i, float further) {
    int parts = coating_parts(table, group);
    float side = i % 2 == 0 ? 1.0f : -1.0f;
    Lobe lobe = coating_lobe_of(place, coating_part(table, place, group, i / 2), side);
    if (further > 0.0f)
        lobe = joined_lobe(lobe, coating_lobe_of(place, coating_part(table, place, COATING_FURTHER, i / 2), side), further);
    lobe.energy = parts > 1 ? 0.5f / float(parts) : 1.0f;
    return lobe;
}
