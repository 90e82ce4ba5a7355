// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's materials; see MaterialCache of core/passes/gpu_scene.h.
#include "lib/microfacet.glsl"
#include "lib/coverage.glsl"

struct Material {
    vec4 color_roughness;  // of a texture, its mean
    vec4 reflection_ior;
    vec4 absorption;
    vec4 class_roughness[MAX_ROUGHNESS_CLASSES / 4];  // ascending; the last one repeats itself
    ivec4 tables;                                     // entering, leaving, reflection (-1: none)
};
layout(std430, binding = 0) readonly buffer Materials { Material materials[]; };

float class_roughness(Material material, int i) { return material.class_roughness[i / 4][i % 4]; }

// The shares of the classes from `first` on in a roughness.
vec4 class_shares(Material material, float roughness, int first) {
    roughness = min(roughness, class_roughness(material, MAX_ROUGHNESS_CLASSES - 1));
    vec4 shares;
    for (int i = 0; i < 4; ++i) {
        int c = first + i;
        float here = c == 0 ? 1.0
                            : upper_class_share(roughness, class_roughness(material, c - 1), class_roughness(material, c));
        float above = c + 1 == MAX_ROUGHNESS_CLASSES
                          ? 0.0
                          : upper_class_share(roughness, class_roughness(material, c), class_roughness(material, c + 1));
        shares[i] = here - above;
    }
    return shares;
}
