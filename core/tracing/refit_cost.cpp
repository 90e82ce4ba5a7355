// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/refit_cost.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace verglas {
namespace {

struct Box {
    glm::vec3 lower{std::numeric_limits<float>::max()};
    glm::vec3 upper{std::numeric_limits<float>::lowest()};

    float half_area() const {
        const glm::vec3 d = upper - lower;
        return d.x * d.y + d.y * d.z + d.z * d.x;
    }
};

Box merged(const Box& a, const Box& b) { return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)}; }

// Boxes of some of the mesh's triangles, evenly spread over their indices.
std::vector<Box> sample_boxes(const Mesh& mesh) {
    const std::size_t triangles = mesh.triangle_count();
    const std::size_t count = std::min(triangles, std::clamp<std::size_t>(triangles / 16, 64, 4096));
    std::vector<Box> boxes(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t* corner = &mesh.indices()[3 * (i * triangles / count)];
        for (int c = 0; c < 3; ++c) {
            const glm::vec3& p = mesh.positions()[corner[c]];
            boxes[i] = merged(boxes[i], {p, p});
        }
    }
    return boxes;
}

// The lowest 10 bits of a number, with two zeros after each.
std::uint32_t spaced(std::uint32_t x) {
    x = (x | x << 16) & 0x030000ffU;
    x = (x | x << 8) & 0x0300f00fU;
    x = (x | x << 4) & 0x030c30c3U;
    return (x | x << 2) & 0x09249249U;
}

// Indices of the boxes along a Morton curve through their centres.
std::vector<std::uint32_t> morton_order(const std::vector<Box>& boxes) {
    const Box all = std::accumulate(boxes.begin(), boxes.end(), Box(), merged);
    const glm::vec3 scale =
        1023.0F / glm::max(all.upper - all.lower, glm::vec3(std::numeric_limits<float>::min()));
    std::vector<std::uint32_t> codes;
    codes.reserve(boxes.size());
    for (const Box& box : boxes) {
        const glm::uvec3 cell((0.5F * (box.lower + box.upper) - all.lower) * scale);
        codes.push_back(spaced(cell.x) | spaced(cell.y) << 1 | spaced(cell.z) << 2);
    }
    std::vector<std::uint32_t> order(boxes.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&codes](std::uint32_t a, std::uint32_t b) {
        return codes[a] != codes[b] ? codes[a] < codes[b] : a < b;
    });
    return order;
}

// Of the inner nodes of the balanced binary tree over the boxes in this order.
double summed_area(const std::vector<Box>& boxes, const std::vector<std::uint32_t>& order) {
    std::vector<Box> nodes;
    nodes.reserve(order.size());
    for (const std::uint32_t i : order) nodes.push_back(boxes[i]);
    double sum = 0.0;
    while (nodes.size() > 1) {
        std::size_t parents = 0;
        for (std::size_t i = 0; i + 1 < nodes.size(); i += 2) {
            nodes[parents] = merged(nodes[i], nodes[i + 1]);
            sum += nodes[parents++].half_area();
        }
        if (nodes.size() % 2 == 1) nodes[parents++] = nodes.back();
        nodes.resize(parents);
    }
    return sum;
}

}  // namespace

float refit_cost(const Mesh& built, const Mesh& moved) {
    const std::vector<Box> boxes = sample_boxes(moved);
    const double anew = summed_area(boxes, morton_order(boxes));
    const double refit = summed_area(boxes, morton_order(sample_boxes(built)));
    return anew > 0.0 ? static_cast<float>(refit / anew) : 1.0F;
}

}  // namespace verglas
