// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/scene/mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "core/error.h"

namespace verglas {
namespace {

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool is_normal(const glm::vec3& v) { return is_finite(v) && v != glm::vec3(0.0F); }

using Range = tbb::blocked_range<std::size_t>;

// Triangles or vertices that a thread takes at a time.
constexpr std::size_t grain = 1 << 14;

// Counts of triangles by what is wrong with them, and the bounds of those that can be drawn.
struct Census {
    std::size_t not_finite = 0;
    std::size_t without_area = 0;
    std::size_t first_out_of_range = std::numeric_limits<std::size_t>::max();
    glm::vec3 lower{std::numeric_limits<float>::max()};
    glm::vec3 upper{std::numeric_limits<float>::lowest()};
};

Census sum(const Census& a, const Census& b) {
    return {a.not_finite + b.not_finite, a.without_area + b.without_area,
            std::min(a.first_out_of_range, b.first_out_of_range), glm::min(a.lower, b.lower),
            glm::max(a.upper, b.upper)};
}

// usable: set to whether a triangle can be drawn.
Census census_of(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles,
                 std::vector<char>& usable) {
    const auto count = [&](const Range& range, Census census) {
        for (std::size_t t = range.begin(); t < range.end(); ++t) {
            const glm::uvec3& corner = triangles[t];
            if (std::max({corner.x, corner.y, corner.z}) >= positions.size()) {
                census.first_out_of_range = std::min(census.first_out_of_range, t);
                continue;
            }
            const glm::vec3& a = positions[corner.x];
            const glm::vec3& b = positions[corner.y];
            const glm::vec3& c = positions[corner.z];
            if (!is_finite(a) || !is_finite(b) || !is_finite(c)) {
                ++census.not_finite;
            } else if (glm::cross(b - a, c - a) == glm::vec3(0.0F)) {
                ++census.without_area;
            } else {
                usable[t] = 1;
                census.lower = glm::min(census.lower, glm::min(a, glm::min(b, c)));
                census.upper = glm::max(census.upper, glm::max(a, glm::max(b, c)));
            }
        }
        return census;
    };
    return tbb::parallel_reduce(Range(0, triangles.size(), grain), Census(), count, sum);
}

}  // namespace

Mesh::Mesh(std::string name, std::vector<glm::vec3> positions, std::vector<glm::vec3> normals,
           const std::vector<glm::uvec3>& triangles, const std::vector<std::uint16_t>& slots,
           std::vector<glm::vec2> uvs, ReliefCoordinates relief)
    : name_(std::move(name)),
      positions_(std::move(positions)),
      normals_(std::move(normals)),
      uvs_(std::move(uvs)),
      relief_(std::move(relief)) {
    check_count(normals_.size(), "normals");
    for (const std::vector<glm::vec2>* each : {&uvs_, &relief_.normal_uvs, &relief_.height_uvs}) {
        if (!each->empty()) check_count(each->size(), "texture coordinates");
    }
    if (!relief_.tangents.empty()) check_count(relief_.tangents.size(), "tangents");
    if (!slots.empty() && slots.size() != triangles.size())
        throw Error("Mesh '" + name_ + "' has " + std::to_string(triangles.size()) + " triangles but " +
                    std::to_string(slots.size()) + " material slots.");
    sort_by_slot(triangles, slots, find_usable(triangles));
    mend_normals();
}

void Mesh::check_count(std::size_t count, const char* what) const {
    if (count == positions_.size()) return;
    throw Error("Mesh '" + name_ + "' has " + std::to_string(positions_.size()) + " vertices but " +
                std::to_string(count) + " " + what + ".");
}

// Of each triangle whether it can be drawn; takes the bounds of those.
std::vector<char> Mesh::find_usable(const std::vector<glm::uvec3>& triangles) {
    std::vector<char> usable(triangles.size());
    const Census census = census_of(positions_, triangles, usable);
    if (census.first_out_of_range < triangles.size())
        throw Error("Mesh '" + name_ + "': triangle " + std::to_string(census.first_out_of_range) +
                    " names a vertex that doesn't exist.");
    if (census.not_finite > 0)
        warnings_.push_back("Mesh '" + name_ + "': " + std::to_string(census.not_finite) +
                            " triangles with a position that isn't a finite number are left out.");
    if (census.without_area > 0)
        warnings_.push_back("Mesh '" + name_ + "': " + std::to_string(census.without_area) +
                            " triangles without area are left out.");
    if (census.not_finite + census.without_area < triangles.size()) {
        lower_ = census.lower;
        upper_ = census.upper;
    }
    return usable;
}

void Mesh::sort_by_slot(const std::vector<glm::uvec3>& triangles, const std::vector<std::uint16_t>& slots,
                        const std::vector<char>& usable) {
    const auto slot_of = [&](std::size_t t) { return slots.empty() ? 0 : int{slots[t]}; };
    std::vector<std::uint32_t> counts;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (!usable[t]) continue;
        if (slot_of(t) >= static_cast<int>(counts.size())) counts.resize(slot_of(t) + 1);
        counts[slot_of(t)] += 3;
    }
    std::vector<std::uint32_t> next;
    std::uint32_t first = 0;
    for (int slot = 0; slot < static_cast<int>(counts.size()); ++slot) {
        if (counts[slot] > 0) parts_.push_back({slot, first, counts[slot]});
        next.push_back(first);
        first += counts[slot];
    }
    indices_.resize(first);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (!usable[t]) continue;
        std::uint32_t& at = next[slot_of(t)];
        for (int corner = 0; corner < 3; ++corner) indices_[at++] = triangles[t][corner];
    }
}

void Mesh::mend_normals() {
    const auto are_normals = [this](const Range& range, bool others) {
        return others && std::all_of(normals_.begin() + static_cast<std::ptrdiff_t>(range.begin()),
                                     normals_.begin() + static_cast<std::ptrdiff_t>(range.end()), is_normal);
    };
    if (tbb::parallel_reduce(Range(0, normals_.size(), grain), true, are_normals, std::logical_and<>()))
        return;
    for (std::size_t i = 0; i < indices_.size(); i += 3) {
        for (int corner = 0; corner < 3; ++corner) {
            glm::vec3& normal = normals_[indices_[i + corner]];
            if (is_normal(normal)) continue;
            const glm::vec3& a = positions_[indices_[i]];
            normal =
                glm::normalize(glm::cross(positions_[indices_[i + 1]] - a, positions_[indices_[i + 2]] - a));
        }
    }
}

}  // namespace verglas
