// SPDX-License-Identifier: GPL-3.0-or-later
// Shades what is seen of the thin layers of one group of objects: panes and coated surfaces. All light comes from the
// environment and the lights; what lies behind a pane isn't known here.
#define THIN_LAYERS
#include "local_lights.glsl"
#include "screen_space.glsl"
#include "lobe_tables.glsl"
#include "materials.glsl"
#include "lib/bundle.glsl"
#include "lib/spherical_warping.glsl"
#include "lib/pane.glsl"
#include "lib/pane_lookup.glsl"
#include "lib/coated.glsl"
#include "lib/coated_lookup.glsl"

uniform sampler2D front_roughness;
uniform bool reflection;

layout(location = 0) out vec4 radiance;

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

Pane pane_of(Material material, Layer layer, vec2 roughness) {
    return Pane(material.tables.x, material.tables.y, material.tables.z, material.tables.w, material.reflection_ior.w,
                roughness.x, roughness.y, layer.kind.z != 0);
}

// By the outer side.
vec3 mirrored_radiance(Material material, Pane pane, Place place, vec3 d, bool tail) {
    if (!reflection || pane.reflection_outside < 0) return vec3(0.0);
    Lobe mirror = reflected_lobe(pane.reflection_outside, pane.eta, pane.near_roughness, d, place.side);
    Moments moments = add_lobe(no_moments(), mirror, place.side, 1.0);
    return material.reflection_ior.rgb * incoming_radiance(place, moments, tail);
}

vec3 pane_radiance(Material material, Layer layer, vec2 roughness, vec3 position, vec3 d, vec3 n) {
    Pane pane = pane_of(material, layer, roughness);
    bool tail = layer.edge_tint.w > 0.0;
    vec3 color = material.color_roughness.rgb * material.color_roughness.rgb;  // of two refractions
    Place behind = Place(position, -n);
    Place before = Place(position, n);
    PaneLobes lobes = pane_lobes(pane, d, n);
    vec3 sum = color * (incoming_radiance(behind, lobes.transmitted, tail) + incoming_radiance(behind, lobes.trapped));
    if (reflection) sum += color * incoming_radiance(before, lobes.reflected);
    return sum + mirrored_radiance(material, pane, before, d, tail);
}

vec3 coated_radiance(Material material, Layer layer, vec2 roughness, vec3 position, vec3 d, vec3 n) {
    Coating coating = Coating(pane_of(material, layer, roughness), roughness.y, layer.optical_depth.rgb,
                              layer.base_color.rgb, layer.edge_tint.rgb, layer.base_color.w > 0.0);
    Place place = Place(position, n);
    vec3 color = material.color_roughness.rgb * material.color_roughness.rgb;
    vec3 sum = mirrored_radiance(material, coating.outer, place, d, layer.edge_tint.w > 0.0);
    if (layer.kind.y < 1) return sum;
    BaseLight light = first_bounce(coating, d, n);
    for (int bounce = 1;; ++bounce) {
        vec3 incoming = light.lobe.spread < FANNED_SPREAD
                            ? incoming_radiance(place, leaving_lobe(coating, light, n), false)
                            : incoming_radiance(place, leaving_light(coating, light, n));
        sum += color * light.color * incoming;
        if (bounce >= layer.kind.y || coating.outer.reflection_inside < 0) return sum;
        light = next_bounce(coating, light, n);
    }
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 face = texelFetch(front_faces, pixel, 0);
    if (face.w < 0.0 || decode_group(face.w) != group) discard;
    Material material = materials[decode_material(face.w)];
    if (material.absorption.w >= 0.0) discard;  // refraction.frag.glsl shades it
    Layer layer = layers[decode_material(face.w)];
    vec3 position = position_at(gl_FragCoord.xy, face.z);
    vec3 d = view_direction(position);
    vec3 n = toward_viewer(decode_normal(face.xy), d);
    vec2 roughness = MAX_ROUGHNESS * texelFetch(front_roughness, pixel, 0).xy;
    bool is_pane = layer.kind.x == KIND_PANE;
    radiance = vec4(is_pane ? pane_radiance(material, layer, roughness, position, d, n)
                            : coated_radiance(material, layer, roughness, position, d, n), 1.0);
}
