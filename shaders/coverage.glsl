// SPDX-License-Identifier: GPL-3.0-or-later
// Which part of a footprint on the back faces has which class of roughness (de Rousiers et al. 2012, section 5.1).
// Where roughness varies, CLASSES is defined as the number of classes, and CLASS_LAYERS as that of layers that hold
// four each; else there is one class. Classes are those of the material that the ray leaves through: where its footprint
// reaches over to another material, that one's shares count for its own classes.
#include "materials.glsl"
#include "screen_space.glsl"

#ifdef CLASS_LAYERS
// Shares of classes times coverage, at all scales: layers of the farthest backs, and then of the nearest.
uniform sampler2DArray back_classes;
#else
#define CLASSES 1
#endif

const int COVERAGE_LAYERS = (CLASSES + 3) / 4;

struct Coverage {
    vec4 ratios[COVERAGE_LAYERS];  // of four classes each; their sum is 1
};

float ratio_of_class(Coverage coverage, int i) { return coverage.ratios[i / 4][i % 4]; }

float roughness_of_class(Material material, int i) {
#ifdef CLASS_LAYERS
    return roughness_of_classes(material, i / 4)[i % 4];
#else
    return material.color_roughness.w;
#endif
}

#ifdef CLASS_LAYERS
// Four classes over a square of 2^level pixels about the exit.
vec4 sample_classes(int layer, vec2 pixel, vec4 face, float level) {
    int first = decode_group(face.w) == NEAREST_BACKS ? CLASS_LAYERS : 0;
    return textureLod(back_classes, vec3(pixel / frame_size, float(first + layer)), level);
}

// From shares times coverage. What covers too little to be stored at this scale has the first class.
Coverage normalized_coverage(Coverage shares) {
    float sum = 0.0;
    for (int layer = 0; layer < CLASS_LAYERS; ++layer) sum += dot(shares.ratios[layer], vec4(1.0));
    if (sum <= 0.0) {
        shares.ratios[0].x = 1.0;
        return shares;
    }
    for (int layer = 0; layer < CLASS_LAYERS; ++layer) shares.ratios[layer] /= sum;
    return shares;
}
#endif

// About an exit, over a square of so many pixels.
Coverage coverage_about(vec2 pixel, vec4 face, float pixels) {
#ifdef CLASS_LAYERS
    float level = log2(max(pixels, 1.0));
    Coverage shares;
    for (int layer = 0; layer < CLASS_LAYERS; ++layer)
        shares.ratios[layer] = sample_classes(layer, pixel, face, level);
    return normalized_coverage(shares);
#else
    return Coverage(vec4[1](vec4(1.0, 0.0, 0.0, 0.0)));
#endif
}

float mean_roughness(Coverage coverage, Material material) {
#ifdef CLASS_LAYERS
    float mean = 0.0;
    for (int layer = 0; layer < CLASS_LAYERS; ++layer)
        mean += dot(coverage.ratios[layer], roughness_of_classes(material, layer));
    return mean;
#else
    return material.color_roughness.w;
#endif
}
