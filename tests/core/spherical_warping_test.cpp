// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>

#include "tests/core/model_device.h"
#include "tests/core/reference_layers.h"

namespace verglas {
namespace {

using glm::dvec3;

// A beam that meets facets. The angle between the mean directions o and m lies in the plane of incidence; eta
// is 0 for reflection.
struct Warp {
    double cosine;
    double kappa_o;
    double kappa_m;
    double eta;

    dvec3 o() const { return {std::sqrt(1.0 - cosine * cosine), 0.0, cosine}; }
    friend std::ostream& operator<<(std::ostream& out, const Warp& warp) {
        return out << (warp.eta > 0.0 ? "refraction " : "reflection ") << warp.eta << ", cosine "
                   << warp.cosine << ", kappas " << warp.kappa_o << " and " << warp.kappa_m;
    }
};

// The mean vector of what leaves, by drawing o and m. What doesn't face each other, or is totally reflected,
// doesn't count; nor does Fresnel's factor.
dvec3 drawn_mean(const Warp& warp) {
    constexpr int count = 100000;
    std::mt19937_64 random(3);
    const dvec3 axis = warp.o();
    dvec3 sum(0.0);
    int counted = 0;
    for (int i = 0; i < count; ++i) {
        const dvec3 v = reference::draw_vmf(random, warp.kappa_o);
        const dvec3 o(axis.z * v.x + axis.x * v.z, v.y, axis.z * v.z - axis.x * v.x);
        const dvec3 m = reference::draw_vmf(random, warp.kappa_m);
        const double c = glm::dot(o, m);
        if (c <= 0.0) continue;
        if (warp.eta > 0.0) {
            const double cos2 = 1.0 - (1.0 - c * c) / (warp.eta * warp.eta);
            if (cos2 < 0.0) continue;
            sum += (c / warp.eta - std::sqrt(cos2)) * m - o / warp.eta;
        } else {
            sum += 2.0 * c * m - o;
        }
        ++counted;
    }
    return sum / double(counted);
}

// Of a mean vector of this length: the inverse of A3, by halving.
double kappa_of_length(double length) {
    double low = 1e-3;
    double high = 1e9;
    for (int i = 0; i < 200; ++i) {
        const double middle = std::sqrt(low * high);
        (reference::mean_length(middle) < length ? low : high) = middle;
    }
    return low;
}

double degrees_between(const dvec3& a, const dvec3& b) {
    return glm::degrees(2.0 * std::asin(std::min(0.5 * glm::distance(a, b), 1.0)));
}

class SphericalWarping : public OnDevice {
  protected:
    static std::vector<Answer> warped(const std::vector<Warp>& warps) {
        std::vector<Question> questions;
        for (const Warp& warp : warps)
            questions.push_back({glm::vec4(-warp.o(), warp.kappa_o), glm::vec4(0.0, 0.0, 1.0, warp.kappa_m),
                                 glm::vec4(warp.eta, 0.0, 0.0, 0.0)});
        return ask(MODEL_FUNCTION(warped_beam), questions);
    }
};
ON_BOTH_DEVICES(SphericalWarping);

// A user loses: the width and the place of what a rough side makes of a beam that is wide already; in the
// three examples of the ENDF paper's Figs. 6 and 7.
TEST_P(SphericalWarping, HasTheMomentsOfDrawnDirections) {
    const std::vector<Warp> warps = {
        {1.0, 50.0, 200.0, 0.0}, {0.707, 100.0, 100.0, 0.0}, {0.5, 200.0, 50.0, 0.0},
        {1.0, 50.0, 200.0, 1.5}, {0.707, 100.0, 100.0, 1.5}, {0.5, 200.0, 50.0, 1.5},
    };
    const auto answers = warped(warps);
    for (std::size_t i = 0; i < warps.size(); ++i) {
        const dvec3 truth = drawn_mean(warps[i]);
        const double kappa = kappa_of_length(glm::length(truth));
        const model::Lobe lobe = lobe_of(answers[i]);
        const double found = model::kappa_from_spread(lobe.spread);
        const double turned = degrees_between(dvec3(lobe.direction), glm::normalize(truth));
        std::cout << warps[i] << ": kappa " << kappa << ", by moments " << found << " and " << turned
                  << " degrees off, by Jacobians " << answers[i].b.y << "\n";
        EXPECT_NEAR(found / kappa, 1.0, 0.06) << warps[i];
        EXPECT_LT(turned, 0.25) << warps[i];
    }
}

// A user loses: the same for light that leaves glass, and for sharp beams and facets.
TEST_P(SphericalWarping, HasTheMomentsOfNarrowDistributions) {
    std::vector<Warp> warps;
    for (const double eta : {0.0, 1.5, 1.0 / 1.5})
        for (const double kappa_o : {1e3, 1e5})
            for (const double kappa_m : {1e3, 1e5})
                for (const double cosine : {1.0, 0.85, 0.6}) {
                    if (eta > 0.0 && eta < 1.0 && cosine < 0.8) continue;
                    warps.push_back({cosine, kappa_o, kappa_m, eta});
                }
    const auto answers = warped(warps);
    for (std::size_t i = 0; i < warps.size(); ++i) {
        const dvec3 truth = drawn_mean(warps[i]);
        const model::Lobe lobe = lobe_of(answers[i]);
        EXPECT_NEAR(lobe.spread / (1.0 - glm::length(truth)), 1.0, 0.1) << warps[i];
        EXPECT_LT(degrees_between(dvec3(lobe.direction), glm::normalize(truth)), 0.25) << warps[i];
    }
}

// A researcher loses: the paper's Jacobians, which are right where a warp stretches both axes alike.
TEST_P(SphericalWarping, JacobiansAreExactForStraightSharpBeams) {
    std::vector<Warp> warps;
    for (const double eta : {0.0, 1.5, 1.0 / 1.5})
        for (const double kappa_o : {1e4, 1e8})
            for (const double kappa_m : {1e4, 1e8}) warps.push_back({1.0, kappa_o, kappa_m, eta});
    const auto answers = warped(warps);
    for (std::size_t i = 0; i < warps.size(); ++i) {
        const double truth = kappa_of_length(glm::length(drawn_mean(warps[i])));
        EXPECT_NEAR(answers[i].b.y / truth, 1.0, 0.02) << warps[i];
    }
}

class VmfMasking : public OnDevice {};
ON_BOTH_DEVICES(VmfMasking);

// A researcher loses: masking that fits vMF normals (the ENDF paper, eq. 7), for any roughness and angle.
TEST_P(VmfMasking, IsTheIntegralOverItsNormals) {
    for (const double kappa : {0.05, 0.5, 1.0, 2.5, 3.0, 10.0, 30.0, 100.0, 1000.0}) {
        const double A3 = reference::mean_length(kappa);
        std::vector<Question> questions;
        for (int degrees = 0; degrees <= 90; degrees += 3) {
            const double cosine = std::max(std::cos(glm::radians(double(degrees))), 0.0);
            questions.push_back({glm::vec4(kappa, cosine, 0.0, 0.0), {}, {}});
        }
        double off = 0.0;
        double masking_off = 0.0;
        double paper_off = 0.0;
        const auto answers = ask(MODEL_FUNCTION(facing_area), questions);
        for (std::size_t i = 0; i < questions.size(); ++i) {
            const double cosine = questions[i].a.y;
            const double truth = reference::vmf_facing_area(kappa, cosine);
            const double found = answers[i].a.x;
            const double eq_8 = 0.25 * std::pow(A3 + 1.0, 2.0) * std::cos(std::cbrt(A3) * std::acos(cosine));
            off = std::max(off, std::abs(found - truth));
            masking_off = std::max(masking_off, std::abs(A3 * cosine / found - A3 * cosine / truth));
            paper_off = std::max(paper_off, std::abs(A3 * cosine / eq_8 - A3 * cosine / truth));
        }
        std::cout << "kappa " << kappa << ": area off by " << off << ", G1 by " << masking_off
                  << ", G1 by eq. 8 by " << paper_off << "\n";
        EXPECT_LT(off, 0.008) << kappa;
        EXPECT_LT(masking_off, 0.01) << kappa;
    }
}

}  // namespace
}  // namespace verglas
