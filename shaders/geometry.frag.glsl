// SPDX-License-Identifier: GPL-3.0-or-later
// Front or back faces into a geometry buffer. Where it holds roughness, ROUGHNESS_VALUES is defined, or CLASS_LAYERS
// as the number of layers that hold four classes each.
#include "geometry_buffer.glsl"
#include "lib/constants.glsl"
#include "materials.glsl"

in vec3 view_position;
in vec3 view_normal;
in vec2 uv;

uniform int group;
uniform int material;
uniform bool textured;
uniform sampler2D roughness_texture;

layout(location = 0) out vec4 texel;
#ifdef ROUGHNESS_VALUES
layout(location = 1) out float roughness;
#endif
#ifdef CLASS_LAYERS
layout(location = 1) out vec4 shares[CLASS_LAYERS];
#endif

// As roughness_at of core/tracing/crossing.h; where texels are smaller than pixels, their mean.
float surface_roughness() {
    return textured ? clamp(texture(roughness_texture, uv).r, 0.0, 1.0) : materials[material].color_roughness.w;
}

void main() {
    texel = vec4(encode_normal(view_normal), -view_position.z, encode_index(group, material));
#ifdef ROUGHNESS_VALUES
    roughness = surface_roughness();
#endif
#ifdef CLASS_LAYERS
    float value = surface_roughness();
    for (int layer = 0; layer < CLASS_LAYERS; ++layer) shares[layer] = class_shares(materials[material], value, 4 * layer);
#endif
}
