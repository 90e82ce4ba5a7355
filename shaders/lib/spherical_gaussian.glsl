// SPDX-License-Identifier: GPL-3.0-or-later
// A spherical Gaussian alpha exp(kappa (p.w - 1)), normalised, is a von Mises-Fisher distribution. Its mean
// vector has the length R = A3(kappa) = coth(kappa) - 1 / kappa. Lobes carry `spread` = 1 - R, which keeps its
// precision for sharp lobes, where it is 1 / kappa.

// 1 - A3(kappa), for kappa >= 0.
SHARED float spread_from_kappa(float kappa) {
    if (kappa < 0.1f) return 1.0f - kappa * (1.0f / 3.0f - kappa * kappa / 45.0f);
    if (kappa > 20.0f) return 1.0f / kappa;  // to float's precision
    float e = exp(-2.0f * kappa);
    return 1.0f / kappa - 2.0f * e / (1.0f - e);
}

// Inverse of spread_from_kappa, for spread in (0, 1]; relative error below 1e-4. Start: Banerjee et al. 2005;
// steps: Newton's, with A3' = 1 - A3^2 - 2 A3 / kappa.
SHARED float kappa_from_spread(float spread) {
    if (spread < 0.1f) return 1.0f / max(spread, 1e-12f);
    float R = 1.0f - spread;
    float kappa = R * (3.0f - R * R) / (spread * (2.0f - spread));
    if (kappa < 0.1f) return kappa;
    for (int i = 0; i < 2; ++i) {
        float A3 = 1.0f - spread_from_kappa(kappa);
        kappa += (R - A3) / (1.0f - A3 * A3 - 2.0f * A3 / kappa);
    }
    return kappa;
}
