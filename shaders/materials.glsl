// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's materials; see MaterialCache of core/passes/gpu_scene.h.
#include "lib/microfacet.glsl"
#include "lib/coverage.glsl"

struct Material {
    vec4 color_roughness;  // of a texture, its mean
    vec4 reflection_ior;
    vec4 absorption;
    vec4 class_roughness[MAX_ROUGHNESS_CLASSES / 4];  // ascending; the last one repeats itself
    ivec4 tables;  // entering, leaving, reflection (-1: none)
};
layout(std430, binding = 0) readonly buffer Materials { Material materials[]; };
