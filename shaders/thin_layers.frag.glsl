// SPDX-License-Identifier: GPL-3.0-or-later
// Shades what is seen of the thin layers of one group of objects: with PANE defined, panes; with COATED, coatings.
// Light comes from the environment, the lights and, with BEHIND, through panes from what is drawn of the scene.
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

#ifdef BEHIND
#include "behind.glsl"

// Light under a lobe from the far side: what of it the scene there fills hides the rest.
vec3 with_scene(vec3 incoming, Place place, vec3 direction, float spread) {
    vec4 seen = radiance_behind(place.position, direction, spread);
    return (1.0 - seen.a) * incoming + seen.rgb;
}
#else
vec3 with_scene(vec3 incoming, Place place, vec3 direction, float spread) { return incoming; }
#endif

vec3 incoming_radiance(Place place, WideLobe lobe, float width, bool through) {
    float spread = widened_spread(lobe.spread, width);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < EXIT_TAPS; ++i) sum += incoming_radiance(place, tap_direction(lobe, i), spread);
    sum /= float(EXIT_TAPS);
    return through ? with_scene(sum, place, lobe.direction, spread) : sum;
}

// Under the lobe with these moments; as a core and a tail where the sides' lobes have them.
vec3 incoming_radiance(Place place, Moments moments, bool tail, bool through) {
    if (moments.energy <= 0.0) return vec3(0.0);
    WideLobe lobe = wide_lobe_from_moments(moments);
    vec3 incoming = incoming_radiance(place, lobe, tail ? CORE_WIDTH : 1.0, through);
    if (tail) incoming = mix(incoming, incoming_radiance(place, lobe, TAIL_WIDTH, through), TAIL_SHARE);
    return moments.energy * incoming;
}

// The scene is seen under all of a fan's lobes as one.
vec3 incoming_radiance(Place place, Fan fan, bool through) {
    vec3 sum = vec3(0.0);
    vec3 mean = vec3(0.0);
    float energy = 0.0;
    for (int i = 0; i < FAN_RAYS; ++i) {
        Lobe lobe = fan.lobes[i];
        if (lobe.energy <= 0.0) continue;
        sum += lobe.energy * incoming_radiance(place, lobe.direction, lobe.spread);
        mean += lobe.energy * (1.0 - lobe.spread) * lobe.direction;
        energy += lobe.energy;
    }
    if (!through || energy <= 0.0) return sum;
    float spread = clamp(1.0 - length(mean) / energy, LOBE_MIN_SPREAD, 1.0);
    return energy * with_scene(sum / energy, place, normalize(mean), spread);
}

// By the outer side.
vec3 mirrored_radiance(Material material, Pane pane, Place place, vec3 d, bool tail) {
    if (!reflection || pane.reflection_outside < 0) return vec3(0.0);
    Lobe mirror = reflected_lobe(pane.reflection_outside, pane.eta, pane.near_roughness, d, place.side);
    Moments moments = add_lobe(no_moments(), mirror, place.side, 1.0);
    return material.reflection_ior.rgb * incoming_radiance(place, moments, tail, false);
}

vec3 layer_radiance(Material material, Layer layer, vec2 roughness, vec3 position, vec3 d, vec3 n) {
    Pane pane = Pane(material.tables.x, material.tables.y, material.tables.z, material.tables.w,
                     material.reflection_ior.w, roughness.x, roughness.y, layer.kind.z != 0);
    bool tail = layer.edge_tint.w > 0.0;
    vec3 color = material.color_roughness.rgb * material.color_roughness.rgb;  // of two refractions
    Place behind = Place(position, -n);
    Place before = Place(position, n);
    PaneLobes lobes = pane_lobes(pane, d, n);
    vec3 sum = color * (incoming_radiance(behind, lobes.transmitted, tail, true) +
                        incoming_radiance(behind, lobes.trapped, true));
    if (reflection) sum += color * incoming_radiance(before, lobes.reflected, false);
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
    CoatingTable table;
    CoatingPlace at;
    Place place;
    CoatingColors colors;  // 0 of what isn't shown
};

// How many parts there are to look up of a group.
int shown_parts(Coated coated, int group) {
    return greatest(coated.colors.groups[group]) > 0.0 ? coating_parts(coated.table, group) : 0;
}

Lobe part_of(Coated coated, int group, int i) {
    float further = group == COATING_FIRST ? coated.colors.further : 0.0;
    return coating_part(coated.table, coated.at, group, i, further);
}

// Loops in place of branches, and as few as can be: software OpenGL walks through both sides of each branch, and once
// through each loop.

// Of groups that aren't divided: one lobe, as wide along one axis as lobes at slanted views are.
vec3 narrow_radiance(Coated coated) {
    vec3 sum = vec3(0.0);
    for (int group = 0; group <= COATING_FIRST; ++group) {
        Lobe lobe = coating_lobe(coated.at, part_of(coated, group, 0), 1.0);
        WideLobe wide = wide_lobe(lobe.direction, lobe.spread, coated.place.side);
        int taps = shown_parts(coated, group) == 1 ? EXIT_TAPS : 0;
        for (int i = 0; i < taps; ++i) {
            vec3 incoming = incoming_radiance(coated.place, tap_direction(wide, i), wide.spread);
            sum += coated.colors.groups[group] / float(EXIT_TAPS) * incoming;
        }
    }
    return sum;
}

vec3 divided_radiance(Coated coated) {
    ivec3 ends = ivec3(0);  // of each group's parts
    int all = 0;
    for (int group = 0; group < COATING_GROUPS; ++group) {
        int parts = shown_parts(coated, group);
        all += parts > 1 ? parts : 0;
        ends[group] = all;
    }
    vec3 sum = vec3(0.0);
    for (int i = 0; i < all; ++i) {
        int group = i < ends.x ? COATING_MIRRORED : i < ends.y ? COATING_FIRST : COATING_FURTHER;
        Lobe part = part_of(coated, group, i - (group == COATING_MIRRORED ? 0 : ends[group - 1]));
        vec3 to_one_side = coating_lobe(coated.at, part, 1.0).direction;
        vec3 to_other = coating_lobe(coated.at, part, -1.0).direction;
        vec3 incoming = incoming_wide_radiance(to_one_side, to_other, part.spread) +
                        local_radiance(coated.place, to_one_side, part.spread) +
                        local_radiance(coated.place, to_other, part.spread);
        sum += part.energy * coated.colors.groups[group] * incoming;
    }
    return sum;
}

vec3 layer_radiance(Material material, Layer layer, vec2 roughness, vec3 position, vec3 d, vec3 n) {
    CoatingTable table = CoatingTable(layer.table.x, layer.table.y, layer.table.z, layer.table.w,
                                      layer.table_ranges.x, layer.table_ranges.y, layer.table_ranges.z,
                                      layer.table_ranges.w);
    Coating coating = Coating(table, roughness.x, roughness.y, layer.optical_depth.rgb, layer.base_color.rgb,
                              layer.edge_tint.rgb, layer.base_color.w > 0.0, layer.kind.y);
    CoatingPlace at = coating_place(coating, d, n);
    CoatingColors colors = coating_colors(coating, coating_light(table, at));
    colors.groups[COATING_MIRRORED] *= reflection ? material.reflection_ior.rgb : vec3(0.0);
    vec3 refracted = material.color_roughness.rgb * material.color_roughness.rgb;
    colors.groups[COATING_FIRST] *= refracted;
    colors.groups[COATING_FURTHER] *= refracted;
    Coated coated = Coated(table, at, Place(position, n), colors);
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
