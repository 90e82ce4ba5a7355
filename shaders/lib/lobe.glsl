// SPDX-License-Identifier: GPL-3.0-or-later
// The lobes of rough interfaces, read from tables (de Rousiers et al. 2012, eqs. 8 and 9; method: mean vector
// of Walter's weights instead of a fit). A node of a table holds (energy, log2(spread / alpha^2), bend, away). The
// mean direction lies in the plane of incidence: away is its cosine to the normal on the lobe's side, bend its sine
// divided by that of the incident direction, which stays smooth at straight incidence.

// Resolution of the tables: an odd number of cosines, so that one lies at the critical angle.
const int LOBE_COSINES = 65;
const int LOBE_ROUGHNESSES = 40;
// Below this roughness the tables' shape stays, and only the lobe's width goes on to shrink.
const float LOBE_MIN_ROUGHNESS = 0.03f;
const float LOBE_MIN_SPREAD = 1e-9f;

// energy W: transmitted or reflected part, 0 … 1. spread: 1 - R. direction: unit mean direction.
struct Lobe {
    float energy;
    float spread;
    vec3 direction;
};

// A lobe in the plane of incidence of its interface. Its unit mean direction has the cosine `away` to the normal on the
// lobe's side and `along` to the tangent that points as the light of the viewer's ray would go on.
struct PlanarLobe {
    float energy;
    float spread;
    float along;
    float away;
};

// Table axis of the cosine. Energy and angle go like the square root of the distance from grazing (eta >= 1)
// or from the critical angle (eta < 1, at x = 1/2), so the axis does too.
SHARED float lobe_table_x(float cos_theta, float eta) {
    if (eta >= 1.0f) return sqrt(cos_theta);
    float cos_critical = critical_cosine(eta);
    if (cos_theta < cos_critical) return 0.5f - 0.5f * sqrt(1.0f - cos_theta / cos_critical);
    return 0.5f + 0.5f * sqrt((cos_theta - cos_critical) / (1.0f - cos_critical));
}

// Inverse of lobe_table_x.
SHARED float lobe_table_cosine(float x, float eta) {
    if (eta >= 1.0f) return x * x;
    float cos_critical = critical_cosine(eta);
    float t = 2.0f * x - 1.0f;
    return x < 0.5f ? cos_critical * (1.0f - t * t) : cos_critical + (1.0f - cos_critical) * t * t;
}

// Table axis of roughness: its cube root, a compromise between edges, whose width goes like alpha, and the
// fast change of wide distributions.
SHARED float lobe_table_y(float roughness) {
    float least = pow(LOBE_MIN_ROUGHNESS, 1.0f / 3.0f);
    return (pow(clamp(roughness, LOBE_MIN_ROUGHNESS, 1.0f), 1.0f / 3.0f) - least) / (1.0f - least);
}

// Inverse of lobe_table_y.
SHARED float lobe_table_roughness(float y) {
    float root = mix(pow(LOBE_MIN_ROUGHNESS, 1.0f / 3.0f), 1.0f, y);
    return root * root * root;
}
