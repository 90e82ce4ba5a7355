// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "core/scene/texture.h"
#include "tests/core/model_device.h"

namespace verglas {
namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;

// Unit vectors in all directions.
std::vector<vec3> directions(int count) {
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    std::vector<vec3> result(count);
    for (vec3& d : result) d = glm::normalize(vec3(normal(random), normal(random), normal(random)));
    return result;
}

// A unit vector in the plane of n.
vec3 beside(const vec3& n, const vec3& otherwise) {
    return glm::normalize(otherwise - glm::dot(otherwise, n) * n);
}

class Relief : public OnDevice {
  protected:
    static std::vector<vec3> normals(const ModelFunction& function, const std::vector<Question>& questions) {
        std::vector<vec3> result;
        for (const Answer& answer : ask(function, questions)) result.emplace_back(answer.a);
        return result;
    }
};
ON_BOTH_DEVICES(Relief);

// A user loses: normal maps that lean the way they were painted, whatever way the surface looks and whether
// or not its coordinates are mirrored.
TEST_P(Relief, NormalMapLeansAlongTangentAndBitangent) {
    const std::vector<vec3> d = directions(40);
    std::vector<Question> questions;
    std::vector<vec3> expected;
    for (std::size_t i = 0; i + 1 < d.size(); ++i) {
        const vec3& n = d[i];
        const vec3 t = beside(n, d[i + 1]);
        const float sign = i % 2 == 0 ? 1.0F : -1.0F;
        const float strength = i % 3 == 0 ? 0.5F : 1.0F;
        const vec3 lean = glm::normalize(vec3(0.3F, -0.5F, 0.8F));
        questions.push_back({vec4(n, strength), vec4(0.5F + 0.5F * lean, 1.0F), vec4(t, sign)});
        const vec3 mapped = lean.x * t + sign * lean.y * glm::cross(n, t) + lean.z * n;
        expected.push_back(glm::normalize(glm::mix(n, mapped, strength)));
    }
    const std::vector<vec3> found = normals(MODEL_FUNCTION(normal_of_map), questions);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_LT(glm::distance(found[i], expected[i]), 1e-5F);
}

// A user loses: the strength of normal maps as EEVEE and, from 4.0 on, Cycles have it.
TEST_P(Relief, NormalMapIsSteepened) {
    const vec3 lean = glm::normalize(vec3(0.3F, -0.5F, 0.8F));
    const vec4 n(0, 0, 1, 1);
    const vec4 tangent(1, 0, 0, 1);
    const std::vector<float> steepness = {0.0F, 0.4F, 1.0F, 2.5F};
    std::vector<Question> questions;
    for (const float s : steepness) questions.push_back({n, vec4(0.5F + 0.5F * lean, s), tangent});
    const std::vector<vec3> found = normals(MODEL_FUNCTION(normal_of_map), questions);
    for (std::size_t i = 0; i < found.size(); ++i) {
        const float s = steepness[i];
        const vec3 expected(s * lean.x, s * lean.y, glm::mix(1.0F, lean.z, std::min(s, 1.0F)));
        EXPECT_LT(glm::distance(found[i], glm::normalize(expected)), 1e-5F);
    }
}

// The plane z = 0.3 x - 0.2 y over a flat surface has the normal (-0.3, 0.2, 1), measured along any two
// vectors. A user loses: bumps as steep as they are high, on triangles of any shape.
TEST_P(Relief, BumpOfASlopeIsItsNormal) {
    const vec2 slope_of_plane(0.3F, -0.2F);
    std::vector<Question> questions;
    for (int i = 0; i < 40; ++i) {
        const float angle = 0.7F * float(i);
        const vec2 first = 0.02F * vec2(std::cos(angle), std::sin(angle));
        const vec2 second =
            3.0F * vec2(std::cos(angle + 0.1F + float(i) / 16.0F), std::sin(angle + 0.1F + float(i) / 16.0F));
        questions.push_back({vec4(0, 0, 1, 1), vec4(first, 0.0F, glm::dot(first, slope_of_plane)),
                             vec4(second, 0.0F, glm::dot(second, slope_of_plane))});
    }
    const vec3 expected = glm::normalize(vec3(-slope_of_plane, 1.0F));
    for (const vec3& found : normals(MODEL_FUNCTION(normal_of_bump), questions))
        EXPECT_LT(glm::distance(found, expected), 1e-4F);
}

// A user loses: triangles without extent in the coordinates of a texture, and colours without direction, that
// are plain glass and not black.
TEST_P(Relief, WhatHasNoDirectionBendsNothing) {
    const vec4 n(0, 0, 1, 1);
    const vec4 tangent(1, 0, 0, 1);
    const std::vector<vec3> mapped =
        normals(MODEL_FUNCTION(normal_of_map),
                {{n, vec4(0.5F, 0.5F, 0.5F, 1), tangent}, {n, vec4(0.5F, 0.5F, 1, 1), vec4(0)}});
    const std::vector<vec3> bumped =
        normals(MODEL_FUNCTION(normal_of_bump), {{n, vec4(0), vec4(0)},
                                                 {n, vec4(1, 0, 0, 0.5F), vec4(2, 0, 0, 1)},
                                                 {n, vec4(1, 0, 0, 0), vec4(0, 1, 0, 0)}});
    for (const auto* found : {&mapped, &bumped})
        for (const vec3& each : *found) EXPECT_EQ(each, vec3(0, 0, 1));
}

// A user loses: light at the rims of bumps, where a mirror image inside the surface would leave nothing but
// black.
TEST_P(Relief, BentNormalsMirrorTheViewerToOutside) {
    const std::vector<vec3> d = directions(600);
    std::vector<Question> questions;
    for (std::size_t i = 0; i + 2 < d.size(); i += 3) {
        const vec3& g = d[i];
        const vec3 o = glm::dot(d[i + 1], g) < 0.0F ? -d[i + 1] : d[i + 1];
        const vec3 n = glm::normalize(d[i + 2] + (0.1F + std::abs(glm::dot(d[i + 2], g))) * g);
        questions.push_back({vec4(n, 0), vec4(g, 0), vec4(o, 0)});
    }
    const std::vector<vec3> found = normals(MODEL_FUNCTION(normal_that_mirrors), questions);
    int turned = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const vec3 n(questions[i].a);
        const vec3 g(questions[i].b);
        const vec3 o(questions[i].c);
        const auto height = [&](const vec3& normal) { return glm::dot(glm::reflect(-o, normal), g); };
        const float least = std::min(0.9F * glm::dot(o, g), 0.01F);
        EXPECT_NEAR(glm::length(found[i]), 1.0F, 1e-4F);
        EXPECT_GT(height(found[i]), least - 1e-3F);
        if (height(n) >= least) {
            EXPECT_EQ(found[i], n);
        } else {
            ++turned;
            EXPECT_NEAR(height(found[i]), least, 1e-3F);  // no farther than it takes
            EXPECT_NEAR(glm::dot(found[i], glm::normalize(glm::cross(n, g))), 0.0F, 1e-3F);
        }
    }
    EXPECT_GT(turned, 20);
}

// A user loses: slopes of painted heights in the units of their coordinates, across the borders of tiles,
// too.
TEST(Texture, SlopeIsTheHeightsDerivative) {
    const int size = 128;
    std::vector<float> heights;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            heights.push_back(std::sin(glm::two_pi<float>() * (float(x) + 0.5F) / size) +
                              2.0F * std::cos(glm::two_pi<float>() * (float(y) + 0.5F) / size));
    const Texture texture("Hills", size, size, heights, Extension::Repeat);
    for (const vec2 uv : {vec2(0.0F), vec2(0.3F, 0.7F), vec2(1.999F, -0.25F), vec2(0.5F, 0.999F)}) {
        const vec2 expected = glm::two_pi<float>() * vec2(std::cos(glm::two_pi<float>() * uv.x),
                                                          -2.0F * std::sin(glm::two_pi<float>() * uv.y));
        EXPECT_LT(glm::distance(slope(texture, uv), expected), 0.02F) << uv.x << " " << uv.y;
    }
}

}  // namespace
}  // namespace verglas
