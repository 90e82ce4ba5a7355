// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's materials; see MaterialCache of core/passes/gpu_scene.h.
#include "lib/microfacet.glsl"
#include "lib/coverage.glsl"

struct Material {
    vec4 color_roughness;  // of a texture, its mean
    vec4 reflection_ior;
    vec4 absorption;  // w: above 0 where lobes have tails (lib/bundle.glsl), below 0 for thin layers
    uint class_roughness[MAX_ROUGHNESS_CLASSES / 2];  // two in each; ascending; the last one repeats itself
    ivec4 tables;  // or kinds of lobes: entering, leaving, reflection outside and inside (-1: none)
};

// Of four classes in a row, from class 4 * layer on. Packed, as software OpenGL takes long to read from buffers.
vec4 roughness_of_classes(Material material, int layer) {
    return vec4(unpackUnorm2x16(material.class_roughness[2 * layer]),
                unpackUnorm2x16(material.class_roughness[2 * layer + 1]));
}

layout(std430, binding = 0) readonly buffer Materials { Material materials[]; };

#ifdef THIN_LAYERS
// Layer of core/scene/scene.h, by material.
struct Layer {
    vec4 base_color;     // w: 1 for a diffuse base
    vec4 edge_tint;      // w: 1 where the material's lobes have tails
    vec4 optical_depth;  // of a coating, straight through
    ivec4 kind;          // KIND_*, bounces, whether a pane has inner reflections
    ivec4 table;         // of a coating: first row, nodes of outer side and base, divided groups
    vec4 table_ranges;   // of outer side and base
};

layout(std430, binding = 1) readonly buffer Layers { Layer layers[]; };
#endif
