// SPDX-License-Identifier: GPL-3.0-or-later
// Solids for the tests of the tracers.
#pragma once

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <memory>
#include <vector>

#include "core/scene/mesh.h"

namespace verglas::shapes {

// One smooth mesh of spheres around the origin, of `around` times half as many quads. A radius below 0: the
// sphere faces its centre, as the wall of a hollow does.
inline std::shared_ptr<const Mesh> spheres(const std::vector<float>& radii, unsigned around = 96) {
    const unsigned down = around / 2;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::uvec3> triangles;
    for (const float radius : radii) {
        const auto first = static_cast<unsigned>(positions.size());
        for (unsigned j = 0; j <= down; ++j) {
            for (unsigned i = 0; i <= around; ++i) {
                const float theta = glm::pi<float>() * float(j) / down;
                const float azimuth = glm::two_pi<float>() * float(i) / around;
                const glm::vec3 n(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
                                  std::cos(theta));
                positions.push_back(std::abs(radius) * n);
                normals.push_back(radius < 0.0F ? -n : n);
            }
        }
        const auto add = [&](unsigned a, unsigned b, unsigned c) {
            triangles.push_back(radius < 0.0F ? glm::uvec3(a, c, b) : glm::uvec3(a, b, c));
        };
        for (unsigned j = 0; j < down; ++j) {
            for (unsigned i = 0; i < around; ++i) {
                const unsigned a = first + j * (around + 1) + i;
                const unsigned b = a + around + 1;
                if (j + 1 < down) add(a, b, b + 1);
                if (j > 0) add(a, b + 1, a + 1);
            }
        }
    }
    return std::make_shared<const Mesh>("Spheres", positions, normals, triangles,
                                        std::vector<std::uint16_t>());
}

// Radius 1, at the origin, smooth.
inline std::shared_ptr<const Mesh> sphere() { return spheres({1.0F}); }

// -1 … 1 in X and Y, and these Z. A slot a face: -X, X, -Y, Y, bottom, top.
inline std::shared_ptr<const Mesh> slab(float bottom, float top) {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::uvec3> triangles;
    std::vector<std::uint16_t> slots;
    const glm::vec3 center(0.0F, 0.0F, 0.5F * (bottom + top));
    const glm::vec3 half(1.0F, 1.0F, 0.5F * (top - bottom));
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0F, 1.0F}) {
            glm::vec3 n(0.0F);
            n[axis] = side;
            glm::vec3 u(0.0F);
            u[(axis + 1) % 3] = 1.0F;
            const glm::vec3 v = glm::cross(n, u);
            const auto first = static_cast<unsigned>(positions.size());
            for (const glm::vec3& corner : {n - u - v, n + u - v, n + u + v, n - u + v}) {
                positions.push_back(center + half * corner);
                normals.push_back(n);
            }
            triangles.emplace_back(first, first + 1, first + 2);
            triangles.emplace_back(first, first + 2, first + 3);
            slots.insert(slots.end(), 2, static_cast<std::uint16_t>(first / 4));
        }
    }
    return std::make_shared<const Mesh>("Slab", positions, normals, triangles, slots);
}

}  // namespace verglas::shapes
