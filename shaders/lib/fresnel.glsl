// SPDX-License-Identifier: GPL-3.0-or-later

// Reflectance of a smooth dielectric for unpolarised light (Walter et al. 2007, eq. 22).
// cos_theta: cosine between direction and normal, above 0 … 1. eta: n_behind / n_before. Returns 0 … 1; 1 beyond
// the critical angle.
SHARED float fresnel_dielectric(float cos_theta, float eta) {
    // With g = 0 the formula gives 1 by itself.
    float g = sqrt(max(eta * eta - 1.0f + cos_theta * cos_theta, 0.0f));
    float a = (g - cos_theta) / (g + cos_theta);
    float b = (cos_theta * (g + cos_theta) - 1.0f) / (cos_theta * (g - cos_theta) + 1.0f);
    return 0.5f * a * a * (1.0f + b * b);
}

// Cosine at the critical angle of total internal reflection; 0 where there is none (eta >= 1).
SHARED float critical_cosine(float eta) { return eta < 1.0f ? sqrt(1.0f - eta * eta) : 0.0f; }
