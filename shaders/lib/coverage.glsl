// SPDX-License-Identifier: GPL-3.0-or-later
// Classes of roughness that stand for what a texture holds (de Rousiers et al. 2012, section 5.1). There they are
// few and distinct; here any roughness is shared between the class below and the one above it, so that continuous
// textures stay continuous.

const int MAX_ROUGHNESS_CLASSES = 8;

// The share of the upper of two neighbouring classes, 0 … 1; of two that are the same, 0. Linear in alpha^2, to which the
// variance of a narrow lobe is proportional: what the two classes' lobes add up to is as wide as the lobe of the
// roughness itself.
SHARED float upper_class_share(float roughness, float lower, float upper) {
    if (upper <= lower) return 0.0f;
    float alpha = alpha_from_roughness(roughness);
    float alpha_lower = alpha_from_roughness(lower);
    float alpha_upper = alpha_from_roughness(upper);
    float range = alpha_upper * alpha_upper - alpha_lower * alpha_lower;
    return clamp((alpha * alpha - alpha_lower * alpha_lower) / max(range, 1e-12f), 0.0f, 1.0f);
}
