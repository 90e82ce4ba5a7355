// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's materials; see MaterialCache of core/passes/gpu_scene.h.
#include "lib/microfacet.glsl"
#include "lib/coverage.glsl"

struct Material {
    vec4 color_roughness;  // of a texture, its mean
    vec4 reflection_ior;
    vec4 absorption;  // w: above 0 where lobes have tails (lib/bundle.glsl)
    uint class_roughness[MAX_ROUGHNESS_CLASSES / 2];  // two in each; ascending; the last one repeats itself
    ivec4 tables;  // entering, leaving, reflection outside and inside (-1: none)
};

// Of four classes in a row, from class 4 * layer on. Packed, as software OpenGL takes long to read from buffers.
vec4 roughness_of_classes(Material material, int layer) {
    return vec4(unpackUnorm2x16(material.class_roughness[2 * layer]),
                unpackUnorm2x16(material.class_roughness[2 * layer + 1]));
}

layout(std430, binding = 0) readonly buffer Materials { Material materials[]; };
