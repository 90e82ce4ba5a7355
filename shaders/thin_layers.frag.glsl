// SPDX-License-Identifier: GPL-3.0-or-later
// Shades what is seen of the thin layers of one group of objects: with PANE defined, panes; with COATED, coated surfaces.
// All light comes from the environment and the lights; what lies behind a pane isn't known here.
#define THIN_LAYERS
#include "local_lights.glsl"
#include "screen_space.glsl"
#include "materials.glsl"
#include "lib/bundle.glsl"

uniform sampler2D front_roughness;
uniform bool reflection;

layout(location = 0) out vec4 radiance;

#ifdef PANE
const int SHADED_KIND = KIND_PANE;

#include "lobes.glsl"
#include "lib/spherical_warping.glsl"
#include "lib/pane.glsl"
#include "lib/pane_lookup.glsl"

vec3 incoming_radiance(Place place, WideLobe lobe, float width) {
    float spread = widened_spread(lobe.spread, width);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < EXIT_TAPS; ++i) sum += incoming_radiance(place, tap_direction(lobe, i), spread);
    return sum / float(EXIT_TAPS);
}

// Under the lobe with these moments; as a core and a tail where the sides' lobes have them.
vec3 incoming_radiance(Place place, Moments moments, bool tail) {
    if (moments.energy <= 0.0) return vec3(0.0);
    WideLobe lobe = wide_lobe_from_moments(moments);
    vec3 incoming = incoming_radiance(place, lobe, tail ? CORE_WIDTH : 1.0);
    if (tail) incoming = mix(incoming, incoming_radiance(place, lobe, TAIL_WIDTH), TAIL_SHARE);
    return moments.energy * incoming;
}

vec3 incoming_radiance(Place place, Fan fan) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < FAN_RAYS; ++i) {
        Lobe lobe = fan.lobes[i];
        if (lobe.energy > 0.0) sum += lobe.energy * incoming_radiance(place, lobe.direction, lobe.spread);
    }
    return sum;
}

// By the outer side.
vec3 mirrored_radiance(Material material, Pane pane, Place place, vec3 d, bool tail) {
    if (!reflection || pane.reflection_outside < 0) return vec3(0.0);
    Lobe mirror = reflected_lobe(pane.reflection_outside, pane.eta, pane.near_roughness, d, place.side);
    Moments moments = add_lobe(no_moments(), mirror, place.side, 1.0);
    return material.reflection_ior.rgb * incoming_radiance(place, moments, tail);
}

vec3 layer_radiance(Material material, Layer layer, vec2 roughness, vec3 position, vec3 d, vec3 n) {
    Pane pane = Pane(material.tables.x, material.tables.y, material.tables.z, material.tables.w,
                     material.reflection_ior.w, roughness.x, roughness.y, layer.kind.z != 0);
    bool tail = layer.edge_tint.w > 0.0;
    vec3 color = material.color_roughness.rgb * material.color_roughness.rgb;  // of two refractions
    Place behind = Place(position, -n);
    Place before = Place(position, n);
    PaneLobes lobes = pane_lobes(pane, d, n);
    vec3 sum = color * (incoming_radiance(behind, lobes.transmitted, tail) + incoming_radiance(behind, lobes.trapped));
    if (reflection) sum += color * incoming_radiance(before, lobes.reflected);
    return sum + mirrored_radiance(material, pane, before, d, tail);
}

#else
const int SHADED_KIND = KIND_COATED;

#include "lib/coated.glsl"

uniform sampler2D coating_rows;  // tables one below the other; see core/passes/gpu_scene.h

vec4 sample_coating_row(float column, int row) {
    int i = min(int(column), COATING_ITEMS * COATING_ANGLES - 2);
    return mix(texelFetch(coating_rows, ivec2(i, row), 0), texelFetch(coating_rows, ivec2(i + 1, row), 0),
               column - float(i));
}

#include "lib/coated_lookup.glsl"

// A coated place.
struct Coated {
    Coating coating;
    CoatingPlace at;
    Place place;
    int groups;      // those of the bounces
    mat3 colors;     // by group; 0 where it isn't shown
    float further;   // of the first bounce's light, what is joined to it
    bool has_tails;  // the mirrored lobe
};

// Loops in place of branches, and as few as can be: software OpenGL walks through both sides of each branch, and once
// through each loop.

// Of groups that aren't divided: one lobe, as wide along one axis as lobes at slanted views are; as a core and a tail
// where the outer side's lobes have them.
vec3 narrow_radiance(Coated coated) {
    CoatingTable table = coated.coating.table;
    vec3 sum = vec3(0.0);
    for (int group = 0; group < min(coated.groups, COATING_FURTHER); ++group) {
        bool mirrored = group == COATING_MIRRORED;
        Lobe lobe = narrow_coating_lobe(table, coated.at, group, mirrored ? 0.0 : coated.further);
        WideLobe wide = wide_lobe(lobe.direction, lobe.spread, coated.place.side);
        bool tail = mirrored && coated.has_tails;
        int lobes = is_divided(table, group) ? 0 : (tail ? 2 : 1) * EXIT_TAPS;
        vec3 color = coated.colors[group] / float(EXIT_TAPS);
        for (int i = 0; i < lobes; ++i) {
            bool in_tail = i >= EXIT_TAPS;
            float width = !tail ? 1.0 : in_tail ? TAIL_WIDTH : CORE_WIDTH;
            float share = !tail ? 1.0 : in_tail ? TAIL_SHARE : 1.0 - TAIL_SHARE;
            sum += share * color * incoming_radiance(coated.place, tap_direction(wide, i % EXIT_TAPS),
                                                     widened_spread(wide.spread, width));
        }
    }
    return sum;
}

// Lobes of a divided group.
int divided_lobes(Coated coated, int group) {
    CoatingTable table = coated.coating.table;
    return group < coated.groups && is_divided(table, group) ? 2 * coating_parts(table, group) : 0;
}

vec3 divided_radiance(Coated coated) {
    int mirrored = divided_lobes(coated, COATING_MIRRORED);
    int first = mirrored + divided_lobes(coated, COATING_FIRST);
    int all = first + divided_lobes(coated, COATING_FURTHER);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < all; ++i) {
        int group = i < mirrored ? COATING_MIRRORED : i < first ? COATING_FIRST : COATING_FURTHER;
        int j = i - (i < mirrored ? 0 : i < first ? mirrored : first);
        vec4 part = coating_part(coated.coating.table, coated.at, group, j / 2);
        Lobe lobe = coating_lobe(coated.coating.table, coated.at, group, part, float(1 - 2 * (j & 1)));
        vec3 incoming = blurred_radiance(lobe.direction, max(lobe.spread, environment_spread(0))) +
                        local_radiance(coated.place, lobe.direction, lobe.spread);
        sum += lobe.energy * coated.colors[group] * incoming;
    }
    return sum;
}

vec3 layer_radiance(Material material, Layer layer, vec2 roughness, vec3 position, vec3 d, vec3 n) {
    CoatingTable table = CoatingTable(layer.table.x, layer.table.y, layer.table.z, layer.table.w,
                                      layer.table_ranges.x, layer.table_ranges.y, layer.table_ranges.z,
                                      layer.table_ranges.w);
    Coated coated;
    coated.coating = Coating(table, roughness.x, roughness.y, layer.optical_depth.rgb, layer.base_color.rgb,
                             layer.edge_tint.rgb, layer.base_color.w > 0.0, layer.kind.y);
    coated.at = coating_place(coated.coating, d, n);
    coated.place = Place(position, n);
    coated.groups = min(layer.kind.y, COATING_FURTHER) + 1;
    coated.has_tails = layer.edge_tint.w > 0.0;
    CoatingLight light = coating_light(table, coated.at);
    vec3 refracted = material.color_roughness.rgb * material.color_roughness.rgb;
    vec3 mirrored = reflection ? material.reflection_ior.rgb : vec3(0.0);
    coated.colors = mat3(mirrored * coating_color(coated.coating, light, COATING_MIRRORED),
                         refracted * coating_color(coated.coating, light, COATING_FIRST),
                         refracted * coating_color(coated.coating, light, COATING_FURTHER));
    vec3 joined = is_joined(table) ? coated.colors[COATING_FURTHER] : vec3(0.0);
    coated.colors[COATING_FIRST] += joined;
    coated.further = greatest(joined) / max(greatest(coated.colors[COATING_FIRST]), 1e-12);
    return narrow_radiance(coated) + divided_radiance(coated);
}

#endif

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 face = texelFetch(front_faces, pixel, 0);
    if (face.w < 0.0 || decode_group(face.w) != group) discard;
    Layer layer = layers[decode_material(face.w)];
    if (layer.kind.x != SHADED_KIND) discard;
    vec3 position = position_at(gl_FragCoord.xy, face.z);
    vec3 d = view_direction(position);
    vec3 n = toward_viewer(decode_normal(face.xy), d);
    vec2 roughness = MAX_ROUGHNESS * texelFetch(front_roughness, pixel, 0).xy;
    radiance = vec4(layer_radiance(materials[decode_material(face.w)], layer, roughness, position, d, n), 1.0);
}
