// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's materials; see MaterialCache of core/passes/gpu_scene.h.

struct Material {
    vec4 color_roughness;
    vec4 reflection_ior;
    vec4 absorption;
    ivec4 tables;  // entering, leaving, reflection (-1: none)
};
layout(std430, binding = 0) readonly buffer Materials { Material materials[]; };
