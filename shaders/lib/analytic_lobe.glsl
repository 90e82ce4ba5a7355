// SPDX-License-Identifier: GPL-3.0-or-later
// The lobes of rough interfaces in closed form, in place of tables: the normals of microfacets are a narrow Gaussian
// about their mean, which the mirror's and Snell's law warp (Guo et al. 2016, the ENDF paper, eqs. 12 and 13).
//
// The paper's normals have their mean at n and one concentration. Here they are those that the viewer sees, weighted
// with |o.m|: at slant angles their mean is tilted toward him, and they vary less in the plane of incidence. Light of
// facets beyond the critical angle and light below the horizon is cut off from the Gaussian, Fresnel's factor weights
// three facets of it, and masking is Smith's of the mean direction. Lobes of GGX below the critical angle, which facets
// of its long tail alone refract, are the least like the truth.

// Some facets: their share of those that the viewer sees; their mean tilt from n toward him, in the plane of incidence,
// radians; and its variance in that plane and across it.
struct Facets {
    float share;
    float tilt;
    float in_plane;
    float across;
};

// The part of a standard normal distribution above a limit: its probability, mean and variance.
struct NormalPart {
    float share;
    float mean;
    float variance;
};

// Boyd's (1959) approximation of Mills' ratio, by which the share is off by 1.2 % of itself or less.
SHARED NormalPart normal_above(float limit) {
    float x = abs(limit);
    float density = exp(-0.5f * x * x) / sqrt(2.0f * PI);
    float mean_beyond = ((PI - 1.0f) * x + sqrt(x * x + 2.0f * PI)) / PI;
    float beyond = density / mean_beyond;
    NormalPart part;
    part.share = limit > 0.0f ? beyond : 1.0f - beyond;
    part.mean = limit > 0.0f ? mean_beyond : density / part.share;
    part.variance = clamp(1.0f - part.mean * (part.mean - limit), 0.05f, 1.0f);
    return part;
}

SHARED Facets facets_tilted_above(Facets facets, float limit) {
    float deviation = sqrt(facets.in_plane);
    NormalPart part = normal_above((limit - facets.tilt) / deviation);
    facets.share *= part.share;
    facets.tilt += deviation * part.mean;
    facets.in_plane *= part.variance;
    return facets;
}

SHARED Facets facets_tilted_below(Facets facets, float limit) {
    facets.tilt = -facets.tilt;
    facets = facets_tilted_above(facets, -limit);
    facets.tilt = -facets.tilt;
    return facets;
}

// Both with the moments of all.
SHARED Facets joined_facets(Facets a, Facets b) {
    float share = a.share + b.share;
    float part = b.share / max(share, 1e-12f);
    float distance = b.tilt - a.tilt;
    a.tilt += part * distance;
    a.in_plane = mix(a.in_plane, b.in_plane, part) + part * (1.0f - part) * distance * distance;
    a.share = share;
    return a;
}

// Variance of the slopes of facets along one axis, 1 / kappa_m. GGX's has no bound: of slopes up to sqrt(2), as far as
// facets still matter; fitted to lobes of roughness 0.15 to 1 and indices 1.2 to 2.4.
SHARED float slope_variance(int ndf, float alpha) {
    const float ggx_reach = 2.0f;  // squared slope
    float alpha2 = max(alpha * alpha, 1e-7f);
    if (ndf != NDF_GGX) return 0.5f * alpha2;
    float reach = ggx_reach / alpha2;
    return 0.5f * alpha2 * (log(1.0f + reach) - reach / (1.0f + reach));
}

// Facets with Gaussian slopes that are seen from a direction o. Per area of the surface, a facet whose slope toward the
// viewer is x has the projected area cos + x sin.
SHARED Facets visible_facets(float variance, float cos_theta) {
    float sin_theta = sqrt(1.0f - cos_theta * cos_theta);
    float deviation = max(sin_theta * sqrt(variance), 1e-6f);
    float hidden_beyond = deviation * normal_above(-cos_theta / deviation).mean;
    float area = cos_theta + hidden_beyond;  // mean of those that face the viewer
    float slope = variance * sin_theta / area;
    float narrowing = 1.0f / (1.0f + slope * slope);  // slopes to angles
    Facets facets;
    facets.share = 1.0f;
    facets.tilt = atan(slope);
    facets.in_plane = (variance * (1.0f + hidden_beyond / area) - slope * slope) * narrowing * narrowing;
    facets.across = variance * narrowing;
    return facets;
}

// As many of the facets as send light on: by F or 1 - F of three of them, a Gauss-Hermite rule.
SHARED Facets weighted_facets(Facets facets, int event, float theta, float eta) {
    if (event == EVENT_REFRACT_WITHOUT) return facets;
    Facets sum;
    sum.share = 0.0f;
    sum.tilt = facets.tilt;
    sum.in_plane = 0.0f;
    sum.across = facets.across;
    for (int i = -1; i <= 1; ++i) {
        Facets facet = facets;
        facet.tilt += float(i) * sqrt(3.0f * facets.in_plane);
        facet.in_plane = 0.0f;
        float F = fresnel_dielectric(clamp(cos(theta - facet.tilt), 1e-6f, 1.0f), eta);
        facet.share *= (event == EVENT_REFLECT ? F : 1.0f - F) * (i == 0 ? 2.0f : 0.5f) / 3.0f;
        sum = joined_facets(sum, facet);
    }
    sum.in_plane = max(sum.in_plane, 0.05f * facets.in_plane);
    return sum;
}

// Mean variance over both axes of directions that facets have turned. jacobian: d(m) / d(i), of both axes together;
// cos_theta: of the light that leaves, to the facet. A tilt in the plane of incidence turns light 1 / cos_theta times as
// far as one across it. The paper's concentration kappa_m times the Jacobian has the geometric mean of both variances.
SHARED float warped_variance(Facets facets, float jacobian, float cos_theta) {
    return 0.5f * (facets.in_plane / cos_theta + facets.across * cos_theta) / jacobian;
}

// angle: of the mean direction to the normal on its side.
SHARED PlanarLobe lobe_about(float energy, float variance, float angle, int ndf, float alpha) {
    PlanarLobe lobe;
    lobe.along = sin(angle);
    lobe.away = max(cos(angle), 1e-3f);
    lobe.energy = energy * smith_masking(ndf, alpha, min(lobe.away, 1.0f));
    lobe.spread = clamp(spread_from_kappa(1.0f / variance), LOBE_MIN_SPREAD, 1.0f);
    return lobe;
}

// Those beyond the critical angle reflect all.
SHARED PlanarLobe analytic_reflection(Facets facets, float theta, float eta, int ndf, float alpha) {
    Facets mirrors;
    if (eta < 1.0f) {
        float limit = theta - asin(eta);
        mirrors = joined_facets(facets_tilted_below(facets, limit),
                                weighted_facets(facets_tilted_above(facets, limit), EVENT_REFLECT, theta, eta));
    } else {
        mirrors = weighted_facets(facets, EVENT_REFLECT, theta, eta);
    }
    mirrors = facets_tilted_above(mirrors, 0.5f * (theta - 0.5f * PI));  // light from above the horizon
    float cos_theta = max(cos(theta - mirrors.tilt), 0.05f);
    float variance = warped_variance(mirrors, 0.25f / cos_theta, cos_theta);
    return lobe_about(mirrors.share, variance, theta - 2.0f * mirrors.tilt, ndf, alpha);
}

SHARED PlanarLobe analytic_refraction(Facets facets, int event, float theta, float eta, int ndf, float alpha) {
    if (eta < 1.0f) facets = facets_tilted_above(facets, theta - asin(eta));
    facets = weighted_facets(facets, event, theta, eta);
    float cos_theta = cos(theta - facets.tilt);
    float theta_t = asin(clamp(sin(theta - facets.tilt) / eta, -1.0f, 1.0f));
    float cos_theta_t = max(cos(theta_t), 0.1f);  // along the surface light would turn without bound
    float variance = warped_variance(facets, facet_jacobian(eta, cos_theta, cos_theta_t), cos_theta_t);
    return lobe_about(facets.share, variance, theta_t + facets.tilt, ndf, alpha);
}

// Number of a lobe, as tables have theirs. event: EVENT_*.
SHARED int analytic_lobe_kind(int ndf, int event) { return NDF_COUNT * event + ndf; }

// kind: of analytic_lobe_kind. eta: n_behind / n_before. Beyond the critical angle a refraction keeps what the rough
// interface lets through.
SHARED PlanarLobe analytic_lobe(int kind, float cos_theta, float eta, float roughness) {
    int event = kind / NDF_COUNT;
    int ndf = kind - NDF_COUNT * event;
    float alpha = alpha_from_roughness(roughness);
    Facets facets = visible_facets(slope_variance(ndf, alpha), cos_theta);
    float theta = acos(cos_theta);
    if (event == EVENT_REFLECT) return analytic_reflection(facets, theta, eta, ndf, alpha);
    return analytic_refraction(facets, event, theta, eta, ndf, alpha);
}
