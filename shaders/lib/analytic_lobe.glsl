// SPDX-License-Identifier: GPL-3.0-or-later
// The lobes of rough interfaces in closed form, in place of tables: the normals of microfacets are a narrow Gaussian
// about their mean, which the mirror's and Snell's law warp (Guo et al. 2015, the ENDF paper, eqs. 12 and 13).
//
// The paper's normals have their mean at n and one concentration. Here they are those that the viewer sees, weighted
// with |o.m|: at slant angles their mean is tilted toward him, and they vary less in the plane of incidence. Light of
// facets beyond the critical angle and light below the horizon is cut off from the Gaussian, Fresnel's factor weights
// three facets of it, and masking is Smith's of the mean direction. Lobes of GGX below the critical angle, which facets
// of its long tail alone refract, are the least like the truth.

// Some facets: their share of those that the viewer sees; the mean of their slopes toward him, in the plane of
// incidence; and the variance of slopes in that plane and across it.
struct Facets {
    float share;
    float slope;
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
    float density = exp(-0.5f * min(x * x, 150.0f)) / sqrt(2.0f * PI);  // above underflow, which is slow
    float mean_beyond = ((PI - 1.0f) * x + sqrt(x * x + 2.0f * PI)) / PI;
    float beyond = density / mean_beyond;
    NormalPart part;
    part.share = limit > 0.0f ? beyond : 1.0f - beyond;
    part.mean = limit > 0.0f ? mean_beyond : density / part.share;
    part.variance = clamp(1.0f - part.mean * (part.mean - limit), 0.05f, 1.0f);
    return part;
}

SHARED Facets facets_above(Facets facets, float slope) {
    float deviation = sqrt(facets.in_plane);
    NormalPart part = normal_above((slope - facets.slope) / deviation);
    facets.share *= part.share;
    facets.slope += deviation * part.mean;
    facets.in_plane *= part.variance;
    return facets;
}

SHARED Facets facets_below(Facets facets, float slope) {
    facets.slope = -facets.slope;
    facets = facets_above(facets, -slope);
    facets.slope = -facets.slope;
    return facets;
}

// Both with the moments of all.
SHARED Facets joined_facets(Facets a, Facets b) {
    float share = a.share + b.share;
    float part = b.share / max(share, 1e-12f);
    float distance = b.slope - a.slope;
    a.slope += part * distance;
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

// A direction o in the plane of incidence, above the surface.
struct Incidence {
    float cosine;
    float sine;
};

// Facets with Gaussian slopes that are seen. Per area of the surface, a facet whose slope toward the viewer is x has
// the projected area cos + x sin.
SHARED Facets visible_facets(float variance, Incidence o) {
    float deviation = max(o.sine * sqrt(variance), 1e-6f);
    float hidden = deviation * normal_above(-o.cosine / deviation).mean;
    float area = o.cosine + hidden;  // mean of those that face the viewer
    Facets facets;
    facets.share = 1.0f;
    facets.slope = variance * o.sine / area;
    facets.in_plane = variance * (1.0f + hidden / area) - facets.slope * facets.slope;
    facets.across = variance;
    return facets;
}

// The slope of facets that o meets at the critical angle of eta < 1; those tilted farther toward the viewer let light
// through.
SHARED float critical_slope(Incidence o, float eta) {
    float cosine = critical_cosine(eta);
    return (o.sine * cosine - o.cosine * eta) / max(o.cosine * cosine + o.sine * eta, 1e-6f);
}

// The same of facets that mirror o into the surface; those tilted farther toward the viewer mirror it upward.
SHARED float horizon_slope(Incidence o) { return -o.cosine / (1.0f + o.sine); }

// Of o to the normal of a facet.
SHARED float facet_cosine(Incidence o, float slope) {
    return clamp((o.cosine + slope * o.sine) / sqrt(1.0f + slope * slope), 1e-6f, 1.0f);
}

// What a facet sends on, by F or 1 - F.
SHARED float sent_on(int event, float cos_theta, float eta) {
    float F = fresnel_dielectric(cos_theta, eta);
    return event == EVENT_REFLECT ? F : 1.0f - F;
}

// As many of the facets as send light on: by three of them, a Gauss-Hermite rule.
SHARED Facets weighted_facets(Facets facets, int event, Incidence o, float eta) {
    if (event == EVENT_REFRACT_WITHOUT) return facets;
    float step = sqrt(3.0f * facets.in_plane);
    float low = sent_on(event, facet_cosine(o, facets.slope - step), eta) / 6.0f;
    float middle = sent_on(event, facet_cosine(o, facets.slope), eta) * (2.0f / 3.0f);
    float high = sent_on(event, facet_cosine(o, facets.slope + step), eta) / 6.0f;
    float sum = max(low + middle + high, 1e-12f);
    float shift = step * (high - low) / sum;
    facets.share *= sum;
    facets.slope += shift;
    facets.in_plane = max(step * step * (low + high) / sum - shift * shift, 0.05f * facets.in_plane);
    return facets;
}

// The lobe of facets that turn o to a direction (along, away) of unit length. jacobian: d(m) / d(i), of both axes
// together; cos_theta: of the light that leaves, to the facet. A tilt in the plane of incidence turns light
// 1 / cos_theta times as far as one across it. The lobe has the mean of both variances; the paper's concentration,
// kappa_m times the Jacobian, their geometric mean.
SHARED PlanarLobe warped_lobe(Facets facets, float along, float away, float jacobian, float cos_theta, int ndf,
                              float alpha) {
    float narrowing = 1.0f / (1.0f + facets.slope * facets.slope);  // slopes to angles
    float variance =
        0.5f * narrowing * (narrowing * facets.in_plane / cos_theta + facets.across * cos_theta) / jacobian;
    PlanarLobe lobe;
    lobe.along = along;
    lobe.away = clamp(away, 1e-3f, 1.0f);
    lobe.energy = facets.share * smith_masking(ndf, alpha, lobe.away);
    lobe.spread = clamp(spread_from_kappa(1.0f / variance), LOBE_MIN_SPREAD, 1.0f);
    return lobe;
}

// Those beyond the critical angle reflect all.
SHARED PlanarLobe analytic_reflection(Facets facets, Incidence o, float eta, int ndf, float alpha) {
    Facets mirrors;
    if (eta < 1.0f) {
        float limit = critical_slope(o, eta);
        mirrors = joined_facets(facets_below(facets, limit),
                                weighted_facets(facets_above(facets, limit), EVENT_REFLECT, o, eta));
    } else {
        mirrors = weighted_facets(facets, EVENT_REFLECT, o, eta);
    }
    mirrors = facets_above(mirrors, horizon_slope(o));
    float stretch = 1.0f / sqrt(1.0f + mirrors.slope * mirrors.slope);  // m = stretch (slope, 1)
    float o_m = facet_cosine(o, mirrors.slope);
    float along = o.sine - 2.0f * o_m * stretch * mirrors.slope;
    float away = 2.0f * o_m * stretch - o.cosine;
    float bounded = max(o_m, 0.05f);
    return warped_lobe(mirrors, along, away, 0.25f / bounded, bounded, ndf, alpha);
}

SHARED PlanarLobe analytic_refraction(Facets facets, int event, Incidence o, float eta, int ndf, float alpha) {
    if (eta < 1.0f) facets = facets_above(facets, critical_slope(o, eta));
    facets = weighted_facets(facets, event, o, eta);
    float stretch = 1.0f / sqrt(1.0f + facets.slope * facets.slope);
    float o_m = facet_cosine(o, facets.slope);
    float t_m = sqrt(max(1.0f - (1.0f - o_m * o_m) / (eta * eta), 0.0f));
    float turn = t_m - o_m / eta;  // t = -o / eta - turn m
    float along = o.sine / eta + turn * stretch * facets.slope;
    float away = o.cosine / eta + turn * stretch;
    float bounded = max(t_m, 0.1f);  // along the facet light would turn without bound
    return warped_lobe(facets, along, away, facet_jacobian(eta, o_m, bounded), bounded, ndf, alpha);
}

// Number of a lobe, as tables have theirs. event: EVENT_*.
SHARED int analytic_lobe_kind(int ndf, int event) { return NDF_COUNT * event + ndf; }

// kind: of analytic_lobe_kind. eta: n_behind / n_before. Beyond the critical angle a refraction keeps what the rough
// interface lets through.
SHARED PlanarLobe analytic_lobe(int kind, float cos_theta, float eta, float roughness) {
    int event = kind / NDF_COUNT;
    int ndf = kind - NDF_COUNT * event;
    float alpha = alpha_from_roughness(roughness);
    Incidence o;
    o.cosine = cos_theta;
    o.sine = sqrt(1.0f - cos_theta * cos_theta);
    Facets facets = visible_facets(slope_variance(ndf, alpha), o);
    if (event == EVENT_REFLECT) return analytic_reflection(facets, o, eta, ndf, alpha);
    return analytic_refraction(facets, event, o, eta, ndf, alpha);
}
