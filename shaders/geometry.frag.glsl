// SPDX-License-Identifier: GPL-3.0-or-later
// Front or back faces into a geometry buffer. Where it holds roughness, ROUGHNESS_VALUES is defined, or CLASS_LAYERS
// as the number of layers that hold four classes each; RELIEF where textures bend the normals.
#include "geometry_buffer.glsl"
#include "lib/constants.glsl"
#include "lib/microfacet.glsl"
#include "lib/coverage.glsl"
#ifdef RELIEF
#include "relief.glsl"
#endif

in vec3 view_position;
in vec3 view_normal;
in vec2 uv;

uniform int group;
uniform int material;
uniform bool two_sided;
// Of the outer side and, with values, of the inner one of thin layers, each where there is no texture.
uniform float roughness_value;
uniform bool textured;
uniform sampler2D roughness_texture;
#ifdef ROUGHNESS_VALUES
uniform float inner_roughness_value;
uniform bool inner_textured;
uniform sampler2D inner_roughness_texture;
uniform bool is_pane;  // seen from behind, its sides change places
#endif
uniform float class_roughness[MAX_ROUGHNESS_CLASSES];  // ascending; the last one repeats itself

layout(location = 0) out vec4 texel;
#ifdef ROUGHNESS_VALUES
layout(location = 1) out vec2 roughness;  // of the side that is seen, and of the other; by MAX_ROUGHNESS
#endif
#ifdef CLASS_LAYERS
layout(location = 1) out vec4 shares[CLASS_LAYERS];
#endif

// As roughness_at of core/tracing/crossing.h; where texels are smaller than pixels, their mean.
float surface_roughness() {
    return textured ? clamp(texture(roughness_texture, uv).r, 0.0, 1.0) : roughness_value;
}

#ifdef ROUGHNESS_VALUES
float inner_roughness() {
    return inner_textured ? clamp(texture(inner_roughness_texture, uv).r, 0.0, 1.0) : inner_roughness_value;
}
#endif

#ifdef CLASS_LAYERS
// The shares of four classes in a roughness.
vec4 class_shares(float value, int first) {
    vec4 shares_of_four;
    for (int i = 0; i < 4; ++i) {
        int c = first + i;
        float here = c == 0 ? 1.0 : upper_class_share(value, class_roughness[max(c - 1, 0)], class_roughness[c]);
        int next = min(c + 1, MAX_ROUGHNESS_CLASSES - 1);
        shares_of_four[i] = here - upper_class_share(value, class_roughness[c], class_roughness[next]);
    }
    return shares_of_four;
}
#endif

// To the side that is seen: thin layers are drawn from behind, too.
vec3 surface_normal() {
#ifdef RELIEF
    vec3 outward = bent_normal(normalize(view_normal), view_position);
#else
    vec3 outward = view_normal;
#endif
    return two_sided && !gl_FrontFacing ? -outward : outward;
}

void main() {
    texel = vec4(encode_normal(surface_normal()), -view_position.z, encode_index(group, material));
#ifdef ROUGHNESS_VALUES
    roughness = vec2(surface_roughness(), inner_roughness());
    if (is_pane && !gl_FrontFacing) roughness = roughness.yx;
    roughness /= MAX_ROUGHNESS;
#endif
#ifdef CLASS_LAYERS
    float value = min(surface_roughness(), class_roughness[MAX_ROUGHNESS_CLASSES - 1]);
    for (int layer = 0; layer < CLASS_LAYERS; ++layer) shares[layer] = class_shares(value, 4 * layer);
#endif
}
