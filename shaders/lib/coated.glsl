// SPDX-License-Identifier: GPL-3.0-or-later
// A clear layer on an opaque base. The ENDF paper (section 5) has a lobe in closed form for each of its bounces; here
// the lobes come from tables that hold what light does between both rough sides (core/material/coating_table.h). In the
// frame of the surface, x is along the tangent of d, the direction of propagation from the viewer, and z along n.

// What light has done in the layer: been mirrored by its outer side, met the base once, or more often.
const int COATING_MIRRORED = 0;
const int COATING_FIRST = 1;
const int COATING_FURTHER = 2;
const int COATING_GROUPS = 3;

// Light of a group is one lobe where that is narrow. Else it is divided in parts of equal energy: into slices by the
// angle in the plane of incidence, and these by the distance from it. Each part stands for its mirror image, too. The
// further bounces, which are weak, are joined with the first one part by part; where they are too wide for that, they
// have their slices.
const int COATING_SLICES = 3;
const int COATING_PARTS = 2 * COATING_SLICES;

// A row of a table is one pair of roughnesses: items side by side, each over the viewer's angle. The first two are
// energies and means, those of each group's parts (x, y, z, log2(spread)) of their lobes.
const int COATING_ANGLES = 33;
const int COATING_ITEMS = 2 + COATING_GROUPS * COATING_PARTS;

// Of one material. Rows: those of the base's roughnesses, for each of the outer side's.
struct CoatingTable {
    int first_row;
    int outer_nodes;
    int base_nodes;
    int divided;  // bit g: whether group g is; of the further bounces, whether they are by themselves
    float outer_least;  // range of both, on the axis of coating_axis
    float outer_greatest;
    float base_least;
    float base_greatest;
};

struct Coating {
    CoatingTable table;
    float outer_roughness;
    float base_roughness;
    vec3 optical_depth;  // sigma_a times thickness
    vec3 base_color;     // reflectance at straight incidence, or albedo
    vec3 edge_tint;      // F82
    bool diffuse;
    int bounces;
};

// Where a viewer and two roughnesses are in a table, and the frame of the surface.
struct CoatingPlace {
    float column;  // within an item
    int row;       // of the roughnesses next below
    float base_share;  // of the base's next roughness
    float outer_share;
    vec3 tangent;
    vec3 side;  // across the plane of incidence
    vec3 n;
};

// Energies of the groups for a base that reflects all light.
struct CoatingLight {
    vec3 energy;    // by group; of the further ones that of the second bounce
    float ratio;    // of a bounce's energy to that of the one before, from the third on
    float slant_5;  // mean of x^5 and of (1 - x) x^6 at the base, x = 1 - cos
    float slant_6;
    vec2 way;  // through the layer, in units of its thickness: of the first, and of the further bounces
};

// Axis of roughness; as that of the lobe tables, and on to where coatings end.
SHARED float coating_axis(float roughness) {
    return pow(clamp(roughness, LOBE_MIN_ROUGHNESS, MAX_ROUGHNESS), 1.0f / 3.0f);
}

// Axis of the viewer's angle, 0 … 1 from grazing to straight, along which mean directions turn evenly.
SHARED float coating_column(float cos_theta) { return 1.0f - acos(clamp(cos_theta, 0.0f, 1.0f)) / (0.5f * PI); }

// Schlick's reflectance, lowered so that at 82 degrees, where the cosine is 1/7, it is tint times his (Kutz, Hasan and
// Edmondson 2021), for a mean of x^5 and of (1 - x) x^6, x = 1 - cos.
SHARED vec3 mean_tinted_reflectance(vec3 color, vec3 tint, float slant_5, float slant_6) {
    float at_82 = 6.0f / 7.0f;
    vec3 schlick_82 = color + (vec3(1.0f) - color) * pow(at_82, 5.0f);
    vec3 a = schlick_82 * (vec3(1.0f) - tint) / (pow(at_82, 6.0f) / 7.0f);
    return max(color + (vec3(1.0f) - color) * slant_5 - a * slant_6, vec3(0.0f));
}

SHARED vec3 tinted_reflectance(vec3 color, vec3 tint, float cos_theta) {
    float x = 1.0f - clamp(cos_theta, 0.0f, 1.0f);
    return mean_tinted_reflectance(color, tint, pow(x, 5.0f), (1.0f - x) * pow(x, 6.0f));
}

SHARED bool is_divided(CoatingTable table, int group) { return ((table.divided >> group) & 1) != 0; }

// Whether the further bounces have no lobes of their own.
SHARED bool is_joined(CoatingTable table) { return !is_divided(table, COATING_FURTHER); }

// How many parts a group has; one that isn't divided is the first of them.
SHARED int coating_parts(CoatingTable table, int group) {
    if (!is_divided(table, group)) return 1;
    return group == COATING_FURTHER ? COATING_SLICES : COATING_PARTS;
}

// How many lobes a group has, on both sides of the plane of incidence.
SHARED int coating_lobes(CoatingTable table, int group) {
    int parts = coating_parts(table, group);
    return parts > 1 ? 2 * parts : 1;
}

// Two lobes of energies 1 - share and share as one, by their mean vectors, whose lengths are a = 1 - spread and b of the
// other one. With D between both directions and A the mean of a and b, |mean|^2 = A^2 - share (1 - share) a b D^2.
SHARED Lobe joined_lobe(Lobe lobe, Lobe other, float share) {
    vec3 between = other.direction - lobe.direction;
    float a = 1.0f - lobe.spread;
    float b = 1.0f - other.spread;
    float mean = mix(a, b, share);
    float apart = clamp(share * (1.0f - share) * a * b * dot(between, between) / max(mean * mean, 1e-6f), 0.0f, 1.0f);
    Lobe joined;
    joined.energy = lobe.energy;
    joined.spread = mix(lobe.spread, other.spread, share) + mean * apart / (1.0f + sqrt(1.0f - apart));
    joined.direction = normalize((1.0f - share) * a * lobe.direction + share * b * other.direction);
    return joined;
}

// Factors on light, its energy included.
struct CoatingColors {
    mat3 groups;    // by group; what is joined is the first bounce's
    float further;  // the share of further bounces in that
};

// What a layer leaves of light on its way through, in units of its thickness (Beer-Lambert).
SHARED vec3 left_by_layer(Coating coating, float way) {
    if (greatest(coating.optical_depth) <= 0.0f) return vec3(1.0f);
    return exp(-way * coating.optical_depth);
}

// What the base and the ways through the layer leave.
SHARED CoatingColors coating_colors(Coating coating, CoatingLight light) {
    vec3 first = vec3(0.0f);
    vec3 further = vec3(0.0f);
    if (coating.bounces > 0) {
        vec3 reflectance = coating.diffuse ? coating.base_color
                                           : mean_tinted_reflectance(coating.base_color, coating.edge_tint,
                                                                     light.slant_5, light.slant_6);
        first = light.energy.y * reflectance * left_by_layer(coating, light.way.x);
        // Each further bounce costs the way of one.
        vec3 bounce = reflectance * left_by_layer(coating, light.way.y - light.way.x);
        vec3 color = light.energy.z * reflectance * reflectance * left_by_layer(coating, light.way.y);
        for (int i = 2; i <= coating.bounces; ++i) {
            further += color;
            color = color * light.ratio * bounce;
        }
    }
    vec3 joined = is_joined(coating.table) ? further : vec3(0.0f);
    first += joined;
    CoatingColors colors;
    colors.groups = mat3(vec3(light.energy.x), first, further - joined);
    colors.further = greatest(joined) / max(greatest(first), 1e-12f);
    return colors;
}
