// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes in closed form (shaders/lib/analytic_lobe.glsl) against the BSDF, integrated over directions.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

#include "core/material/lobe_tables.h"
#include "tests/core/model_device.h"
#include "tests/core/reference_lobes.h"

namespace verglas {
namespace {

struct Crossing {
    Ndf ndf;
    LobeEvent event;
    float eta;
    float roughness;
    float cosine;
};

class AnalyticLobe : public OnDevice {
  protected:
    static std::vector<model::PlanarLobe> lobes_of(const std::vector<Crossing>& crossings) {
        std::vector<Question> questions;
        for (const Crossing& c : crossings) {
            const int kind = model::analytic_lobe_kind(static_cast<int>(c.ndf), static_cast<int>(c.event));
            questions.push_back({glm::vec4(c.cosine, c.eta, c.roughness, 0.0F), glm::vec4(0.0F),
                                 glm::vec4(kind, 0.0F, 0.0F, 0.0F)});
        }
        std::vector<model::PlanarLobe> lobes;
        for (const Answer& answer : ask(MODEL_FUNCTION(lobe_in_closed_form), questions))
            lobes.push_back({answer.a.x, answer.a.y, answer.a.z, answer.a.w});
        return lobes;
    }
};
ON_BOTH_DEVICES(AnalyticLobe);

struct Errors {
    double energy = 0.0;
    double degrees = 0.0;
    double log_spread = 0.0;
};

Errors errors_of(const model::PlanarLobe& lobe, const Crossing& c) {
    const auto truth = reference::integrate(c.ndf, c.roughness * c.roughness, c.eta, c.event, c.cosine);
    const glm::dvec3 direction(-lobe.along, 0.0, c.event == LobeEvent::Reflect ? lobe.away : -lobe.away);
    const double cosine = glm::dot(glm::normalize(direction), truth.direction());
    return {std::abs(lobe.energy - truth.energy), glm::degrees(std::acos(std::min(cosine, 1.0))),
            std::abs(std::log(lobe.spread / truth.spread()))};
}

// The greatest and the mean.
struct Summary {
    Errors most;
    Errors mean;
};

Summary summary_of(const std::vector<model::PlanarLobe>& lobes, const std::vector<Crossing>& crossings) {
    Summary summary;
    const auto add = [&](double Errors::*part, const Errors& errors) {
        summary.most.*part = std::max(summary.most.*part, errors.*part);
        summary.mean.*part += errors.*part / static_cast<double>(crossings.size());
    };
    std::vector<Errors> all(crossings.size());
    tbb::parallel_for(std::size_t(0), all.size(),
                      [&](std::size_t i) { all[i] = errors_of(lobes[i], crossings[i]); });
    for (const Errors& errors : all)
        for (const auto part : {&Errors::energy, &Errors::degrees, &Errors::log_spread}) add(part, errors);
    std::cout << "energy off by " << summary.mean.energy << ", at most " << summary.most.energy << "; "
              << summary.mean.degrees << ", at most " << summary.most.degrees << " degrees; ln(spread) by "
              << summary.mean.log_spread << ", at most " << summary.most.log_spread << "\n";
    return summary;
}

// From straight to flat, but for what is near the critical angle or beyond it, which refracts next to
// nothing.
std::vector<Crossing> crossings_of(const std::vector<Ndf>& ndfs, LobeEvent event) {
    std::vector<Crossing> crossings;
    for (const Ndf ndf : ndfs) {
        for (const float eta : {1.5F, 1.0F / 1.5F}) {
            for (const float roughness : {0.15F, 0.25F, 0.4F, 0.55F}) {
                for (const float cosine : {0.99F, 0.9F, 0.7F, 0.5F, 0.3F}) {
                    const float critical = model::critical_cosine(eta);
                    const float alpha = roughness * roughness;
                    if (event != LobeEvent::Reflect && eta < 1.0F && cosine < critical + alpha) continue;
                    crossings.push_back({ndf, event, eta, roughness, cosine});
                }
            }
        }
    }
    return crossings;
}

// A user loses: glass that looks as with tables where none are wanted. Without the tilt of visible facets
// directions are off by up to 14 degrees, with the paper's concentration of reflections spreads by a factor
// of up to 2.
TEST_P(AnalyticLobe, OfGaussianFacetsIsNearTheIntegral) {
    for (const LobeEvent event : {LobeEvent::Refract, LobeEvent::RefractWithout, LobeEvent::Reflect}) {
        const auto crossings = crossings_of({Ndf::Beckmann, Ndf::BlinnPhong}, event);
        const Summary summary = summary_of(lobes_of(crossings), crossings);
        EXPECT_LE(summary.mean.energy, 0.007);
        EXPECT_LE(summary.most.energy, 0.06);
        EXPECT_LE(summary.mean.degrees, 0.5);
        EXPECT_LE(summary.most.degrees, 6.0);
        EXPECT_LE(summary.mean.log_spread, 0.05);
        EXPECT_LE(summary.most.log_spread, 0.2);
    }
}

// The same of GGX, whose long tails a Gaussian doesn't have.
TEST_P(AnalyticLobe, OfGgxIsAboutTheIntegral) {
    for (const LobeEvent event : {LobeEvent::Refract, LobeEvent::RefractWithout, LobeEvent::Reflect}) {
        const auto crossings = crossings_of({Ndf::Ggx}, event);
        const Summary summary = summary_of(lobes_of(crossings), crossings);
        EXPECT_LE(summary.mean.energy, 0.03);
        EXPECT_LE(summary.mean.degrees, 2.0);
        EXPECT_LE(summary.mean.log_spread, 0.35);
    }
}

// A user loses: light beyond the critical angle, that isn't refracted: it is reflected, but for what is
// masked.
TEST_P(AnalyticLobe, WhatIsNotRefractedIsReflected) {
    std::vector<Crossing> crossings;
    for (const LobeEvent event : {LobeEvent::Refract, LobeEvent::Reflect})
        for (const float cosine : {0.99F, 0.9F, 0.8F, 0.7F, 0.6F, 0.5F})
            crossings.push_back({Ndf::Beckmann, event, 1.0F / 1.5F, 0.3F, cosine});
    const auto lobes = lobes_of(crossings);
    for (std::size_t i = 0; i < lobes.size() / 2; ++i)
        EXPECT_NEAR(lobes[i].energy + lobes[i + lobes.size() / 2].energy, 1.0, 0.02)
            << "cosine " << crossings[i].cosine;
}

// A user loses: clear and polished glass, whose lobes are those of Snell's and Fresnel's laws.
TEST_P(AnalyticLobe, OfSmoothSurfacesIsSharp) {
    const std::vector<Crossing> crossings = {{Ndf::Ggx, LobeEvent::Refract, 1.5F, 0.0F, 0.6F},
                                             {Ndf::Beckmann, LobeEvent::Reflect, 1.5F, 0.0F, 0.6F}};
    const auto lobes = lobes_of(crossings);
    EXPECT_NEAR(lobes[0].along, 0.8 / 1.5, 1e-4);
    EXPECT_NEAR(lobes[1].along, 0.8, 1e-4);
    EXPECT_NEAR(lobes[0].energy, 1.0 - reference::fresnel(0.6, 1.5), 1e-4);
    EXPECT_NEAR(lobes[1].energy, reference::fresnel(0.6, 1.5), 1e-4);
    for (const model::PlanarLobe& lobe : lobes) EXPECT_LE(lobe.spread, 1e-5);
}

}  // namespace
}  // namespace verglas
