// SPDX-License-Identifier: GPL-3.0-or-later
// Walter, Marschner, Li, Torrance: Microfacet Models for Refraction through Rough Surfaces (EGSR 2007).

// Width of the distribution of normals for Blender's roughness slider, 0 … 1.
SHARED float alpha_from_roughness(float roughness) { return roughness * roughness; }

// Smith's masking of one direction, 0 … 1: eqs. 27 and 34. Blinn-Phong has the exponent 2 / alpha^2 - 2, as wide as
// Beckmann's distribution, and then the same masking.
// cos_theta: cosine between the direction and the normal of the surface, 0 … 1.
SHARED float smith_masking(int ndf, float alpha, float cos_theta) {
    float cos2 = cos_theta * cos_theta;
    float alpha2_tan2 = alpha * alpha * (1.0f - cos2) / max(cos2, 1e-12f);
    if (ndf == NDF_GGX) return 2.0f / (1.0f + sqrt(1.0f + alpha2_tan2));
    float a = 1.0f / sqrt(max(alpha2_tan2, 1e-12f));
    float rational = (3.535f * a + 2.181f * a * a) / (1.0f + 2.276f * a + 2.577f * a * a);
    return a < 1.6f ? rational : 1.0f;
}
