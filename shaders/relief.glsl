// SPDX-License-Identifier: GPL-3.0-or-later
// The relief of the material that is drawn, as in RayScene::Placed::bent_normal of core/tracing/ray_scene.cpp.
#include "lib/relief.glsl"

in vec3 object_normal;
in vec4 object_tangent;
in vec2 normal_uv;
in vec2 height_uv;

uniform mat4 projection;
uniform bool has_normal_map;
uniform sampler2D normal_map;
uniform mat3 normal_axes;     // of its colours, to camera space; in tangent space of the object
uniform bool tangent_space;
uniform float normal_steepness;
uniform float normal_strength;
uniform bool has_bump;
uniform sampler2D heights;
uniform float bump_strength;
uniform float bump_distance;

// How the height rises along u and v, as slope() of core/scene/texture.h.
vec2 height_slope() {
    vec2 size = vec2(textureSize(heights, 0));
    vec2 half_u = vec2(0.5 / size.x, 0.0);
    vec2 half_v = vec2(0.0, 0.5 / size.y);
    return size * vec2(texture(heights, height_uv + half_u).r - texture(heights, height_uv - half_u).r,
                       texture(heights, height_uv + half_v).r - texture(heights, height_uv - half_v).r);
}

// Of a surface that the camera sees.
vec3 mirroring_normal_at(vec3 n, vec3 position) {
    vec3 o = projection[3][3] == 0.0 ? -normalize(position) : vec3(0.0, 0.0, 1.0);
    vec3 g = unit_or(cross(dFdx(position), dFdy(position)), n);
    return mirroring_normal(n, dot(g, o) < 0.0 ? -g : g, o);
}

// n: interpolated, unit, camera space. position: the same. Which ray meets a back face isn't known.
vec3 bent_normal(vec3 n, vec3 position) {
    if (has_normal_map) {
        mat3 axes = tangent_space ? normal_axes * tangent_frame(object_normal, object_tangent) : normal_axes;
        n = mapped_normal(n, axes, texture(normal_map, normal_uv).rgb, normal_steepness, normal_strength);
    }
    if (has_bump) {
        vec2 rise = bump_distance * height_slope();
        n = bumped_normal(n, dFdx(position), dFdy(position), dot(rise, dFdx(height_uv)), dot(rise, dFdy(height_uv)),
                          bump_strength);
    }
    return gl_FrontFacing && (has_normal_map || has_bump) ? mirroring_normal_at(n, position) : n;
}
