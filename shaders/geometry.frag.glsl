// SPDX-License-Identifier: GPL-3.0-or-later
// Front or back faces into a geometry buffer. ROUGHNESS is defined where it holds that, too.
#include "geometry_buffer.glsl"
#include "materials.glsl"

in vec3 view_position;
in vec3 view_normal;
in vec2 uv;

uniform int group;
uniform int material;

layout(location = 0) out vec4 texel;

#ifdef ROUGHNESS
uniform bool textured;
uniform sampler2D roughness_texture;

layout(location = 1) out float roughness;

// As roughness_at of core/tracing/crossing.h; where texels are smaller than pixels, their mean.
float surface_roughness() {
    return textured ? clamp(texture(roughness_texture, uv).r, 0.0, 1.0) : materials[material].color_roughness.w;
}
#endif

void main() {
    texel = vec4(encode_normal(view_normal), -view_position.z, encode_index(group, material));
#ifdef ROUGHNESS
    roughness = surface_roughness();
#endif
}
