// SPDX-License-Identifier: GPL-3.0-or-later
// What tests ask of the model, in the language of shaders/lib, so that both devices answer the same. Each function
// takes a question to its answer; tests/core/model_device.h.

struct Question {
    vec4 a;
    vec4 b;
    vec4 c;
};

struct Answer {
    vec4 a;
    vec4 b;
};

SHARED Answer answer_of_lobe(Lobe lobe) {
    Answer answer;
    answer.a = vec4(lobe.direction, lobe.energy);
    answer.b = vec4(lobe.spread, 0.0f, 0.0f, 0.0f);
    return answer;
}

// a: kappa, spread. Answer: spread_from_kappa, kappa_from_spread, kappa after going there and back.
SHARED Answer spherical_gaussian(Question question) {
    float spread = spread_from_kappa(question.a.x);
    Answer answer;
    answer.a = vec4(spread, kappa_from_spread(question.a.y), kappa_from_spread(spread), 0.0f);
    answer.b = vec4(0.0f);
    return answer;
}

// a: direction. Answer: environment_uv; the direction after going there and back.
SHARED Answer environment_place(Question question) {
    vec2 uv = environment_uv(vec3(question.a));
    Answer answer;
    answer.a = vec4(uv, 0.0f, 0.0f);
    answer.b = vec4(environment_direction(uv), 0.0f);
    return answer;
}

// a: d, eta. b: n; 1 with Fresnel, else 0. c: TIR_*. Answer: as answer_of_lobe.
SHARED Answer sharp_refraction(Question question) {
    return answer_of_lobe(specular_refraction(question.a.w, question.b.w > 0.5f, vec3(question.a), vec3(question.b),
                                              int(question.c.x)));
}

// a: d, eta. b: n. Answer: as answer_of_lobe.
SHARED Answer sharp_reflection(Question question) {
    return answer_of_lobe(specular_reflection(question.a.w, vec3(question.a), vec3(question.b)));
}

// a: d, eta. b: n, roughness. c: table, TIR_*. Answer: as answer_of_lobe.
SHARED Answer rough_refraction(Question question) {
    return answer_of_lobe(refracted_lobe(int(question.c.x), question.a.w, question.b.w, vec3(question.a),
                                         vec3(question.b), int(question.c.y)));
}

// a: d, eta. b: n, roughness. c: table. Answer: as answer_of_lobe.
SHARED Answer rough_reflection(Question question) {
    return answer_of_lobe(
        reflected_lobe(int(question.c.x), question.a.w, question.b.w, vec3(question.a), vec3(question.b)));
}

// a: cosine, eta, roughness. c: kind. Answer: energy, spread, along and away.
SHARED Answer lobe_in_closed_form(Question question) {
    PlanarLobe lobe = analytic_lobe(int(question.c.x), question.a.x, question.a.y, question.a.z);
    Answer answer;
    answer.a = vec4(lobe.energy, lobe.spread, lobe.along, lobe.away);
    answer.b = vec4(0.0f);
    return answer;
}

// Of the bundle that a ray along -Z becomes, which meets the unit sphere at p; tables 0 and 1: entering and leaving.
SHARED Moments sphere_moments(vec3 p, float eta, float roughness) {
    Lobe front = refracted_lobe(0, eta, roughness, vec3(0.0f, 0.0f, -1.0f), p, TIR_NONE);
    Moments moments = no_moments();
    for (int i = 0; i < BUNDLE_RAYS; ++i) {
        vec3 d = bundle_ray(front, p, bundle_azimuth(i));
        vec3 outward = p - 2.0f * dot(p, d) * d;
        Lobe back = refracted_lobe(1, 1.0f / eta, roughness, d, -outward, TIR_NONE);
        moments = add_lobe(moments, back, outward, front.energy / float(BUNDLE_RAYS));
    }
    return moments;
}

// a: p, eta. b: roughness. Answer: as answer_of_lobe.
SHARED Answer sphere_lobe(Question question) {
    return answer_of_lobe(lobe_from_moments(sphere_moments(vec3(question.a), question.a.w, question.b.x)));
}

// a: p, eta. b: roughness. Answer: direction and spread; axis.
SHARED Answer sphere_wide_lobe(Question question) {
    WideLobe lobe = wide_lobe_from_moments(sphere_moments(vec3(question.a), question.a.w, question.b.x));
    Answer answer;
    answer.a = vec4(lobe.direction, lobe.spread);
    answer.b = vec4(lobe.axis, 0.0f);
    return answer;
}

SHARED Answer answer_of_normal(vec3 n) {
    Answer answer;
    answer.a = vec4(n, 0.0f);
    answer.b = vec4(0.0f);
    return answer;
}

// a: n, strength. b: colour, steepness. c: tangent. Answer: normal.
SHARED Answer normal_of_map(Question question) {
    vec3 n = vec3(question.a);
    mat3 axes = tangent_frame(n, question.c);
    return answer_of_normal(mapped_normal(n, axes, vec3(question.b), question.b.w, question.a.w));
}

// a: n, strength. b, c: a vector in the surface, and how far the height rises along it. Answer: normal.
SHARED Answer normal_of_bump(Question question) {
    return answer_of_normal(bumped_normal(vec3(question.a), vec3(question.b), vec3(question.c), question.b.w,
                                          question.c.w, question.a.w));
}

// a: n. b: g. c: o. Answer: normal.
SHARED Answer normal_that_mirrors(Question question) {
    return answer_of_normal(mirroring_normal(vec3(question.a), vec3(question.b), vec3(question.c)));
}

// a: d, kappa_o. b: n, kappa_m. c: eta of a refraction, 0 for reflection. Answer: as answer_of_lobe, then the
// concentration by the paper's Jacobians.
SHARED Answer warped_beam(Question question) {
    vec3 d = vec3(question.a);
    vec3 n = vec3(question.b);
    float kappa_o = question.a.w;
    float kappa_m = question.b.w;
    float eta = question.c.x;
    float cos_o = -dot(d, n);
    Lobe beam;
    beam.energy = 1.0f;
    beam.spread = spread_from_kappa(kappa_o);
    beam.direction = d;
    Answer answer;
    if (eta > 0.0f) {
        float cos_t = sqrt(1.0f - (1.0f - cos_o * cos_o) / (eta * eta));
        answer = answer_of_lobe(refracted_beam(beam, eta, kappa_m, n));
        answer.b.y = refracted_kappa(kappa_o, kappa_m, eta, cos_o, cos_t);
    } else {
        answer = answer_of_lobe(reflected_beam(beam, kappa_m, n));
        answer.b.y = reflected_kappa(kappa_o, kappa_m, cos_o);
    }
    return answer;
}

// a: kappa, cosine. Answer: approximate_facing_area.
SHARED Answer facing_area(Question question) {
    Answer answer;
    answer.a = vec4(approximate_facing_area(question.a.x, question.a.y), 0.0f, 0.0f, 0.0f);
    answer.b = vec4(0.0f);
    return answer;
}
