// SPDX-License-Identifier: GPL-3.0-or-later
// Walter, Marschner, Li, Torrance: Microfacet Models for Refraction through Rough Surfaces (EGSR 2007).

// Width of the distribution of normals for Blender's roughness slider, 0 … 1.
SHARED float alpha_from_roughness(float roughness) { return roughness * roughness; }

// Exponent of the Blinn-Phong distribution that is as wide as Beckmann's with `alpha`.
SHARED float blinn_phong_exponent(float alpha) { return 2.0f / (alpha * alpha) - 2.0f; }

// D(m), per steradian: eqs. 25, 30 and 33. Normalised so that D(m) (m.n) integrates to 1 over the hemisphere.
SHARED float microfacet_distribution(int ndf, float alpha, float cos_theta_m) {
    if (cos_theta_m <= 0.0f) return 0.0f;
    if (ndf == NDF_BLINN_PHONG) {
        float n_D = blinn_phong_exponent(alpha);
        return (n_D + 2.0f) / (2.0f * PI) * pow(cos_theta_m, n_D);
    }
    float cos2 = cos_theta_m * cos_theta_m;
    float alpha2 = alpha * alpha;
    if (ndf == NDF_GGX) {
        float denominator = cos2 * (alpha2 - 1.0f) + 1.0f;
        return alpha2 / (PI * denominator * denominator);
    }
    return exp((cos2 - 1.0f) / (cos2 * alpha2)) / (PI * alpha2 * cos2 * cos2);
}

// Smith's masking of one direction, 0 … 1: eqs. 27 and 34. With the exponent above, Blinn-Phong's is Beckmann's.
// cos_theta: cosine between the direction and the normal of the surface, 0 … 1.
SHARED float smith_masking(int ndf, float alpha, float cos_theta) {
    float cos2 = cos_theta * cos_theta;
    float alpha2_tan2 = alpha * alpha * (1.0f - cos2) / max(cos2, 1e-12f);
    if (ndf == NDF_GGX) return 2.0f / (1.0f + sqrt(1.0f + alpha2_tan2));
    float a = 1.0f / sqrt(max(alpha2_tan2, 1e-12f));
    float rational = (3.535f * a + 2.181f * a * a) / (1.0f + 2.276f * a + 2.577f * a * a);
    return a < 1.6f ? rational : 1.0f;
}
