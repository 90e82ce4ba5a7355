// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/scene/mesh.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/error.h"

namespace verglas {
namespace {

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

Mesh::Mesh(std::string name, std::vector<glm::vec3> positions, std::vector<glm::vec3> normals,
           const std::vector<glm::uvec3>& triangles, const std::vector<std::uint16_t>& slots,
           std::vector<glm::vec2> uvs)
    : name_(std::move(name)),
      positions_(std::move(positions)),
      normals_(std::move(normals)),
      uvs_(std::move(uvs)) {
    if (normals_.size() != positions_.size())
        throw Error("Mesh '" + name_ + "' has " + std::to_string(positions_.size()) + " vertices but " +
                    std::to_string(normals_.size()) + " normals.");
    if (!uvs_.empty() && uvs_.size() != positions_.size())
        throw Error("Mesh '" + name_ + "' has " + std::to_string(positions_.size()) + " vertices but " +
                    std::to_string(uvs_.size()) + " texture coordinates.");
    if (!slots.empty() && slots.size() != triangles.size())
        throw Error("Mesh '" + name_ + "' has " + std::to_string(triangles.size()) + " triangles but " +
                    std::to_string(slots.size()) + " material slots.");
    sort_by_slot(triangles, slots, usable_triangles(triangles));
    mend_normals();
    find_bounds();
}

std::vector<bool> Mesh::usable_triangles(const std::vector<glm::uvec3>& triangles) {
    std::vector<bool> usable(triangles.size());
    std::size_t not_finite = 0;
    std::size_t without_area = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const glm::uvec3& corner = triangles[t];
        if (std::max({corner.x, corner.y, corner.z}) >= positions_.size())
            throw Error("Mesh '" + name_ + "': triangle " + std::to_string(t) +
                        " names a vertex that doesn't exist.");
        const glm::vec3& a = positions_[corner.x];
        const glm::vec3& b = positions_[corner.y];
        const glm::vec3& c = positions_[corner.z];
        if (!is_finite(a) || !is_finite(b) || !is_finite(c))
            ++not_finite;
        else if (glm::cross(b - a, c - a) == glm::vec3(0.0F))
            ++without_area;
        else
            usable[t] = true;
    }
    if (not_finite > 0)
        warnings_.push_back("Mesh '" + name_ + "': " + std::to_string(not_finite) +
                            " triangles with a position that isn't a finite number are left out.");
    if (without_area > 0)
        warnings_.push_back("Mesh '" + name_ + "': " + std::to_string(without_area) +
                            " triangles without area are left out.");
    return usable;
}

void Mesh::sort_by_slot(const std::vector<glm::uvec3>& triangles, const std::vector<std::uint16_t>& slots,
                        const std::vector<bool>& usable) {
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
    for (std::size_t i = 0; i < indices_.size(); i += 3) {
        for (int corner = 0; corner < 3; ++corner) {
            glm::vec3& normal = normals_[indices_[i + corner]];
            if (is_finite(normal) && normal != glm::vec3(0.0F)) continue;
            const glm::vec3& a = positions_[indices_[i]];
            normal =
                glm::normalize(glm::cross(positions_[indices_[i + 1]] - a, positions_[indices_[i + 2]] - a));
        }
    }
}

void Mesh::find_bounds() {
    if (indices_.empty()) return;
    lower_ = glm::vec3(std::numeric_limits<float>::max());
    upper_ = -lower_;
    for (const std::uint32_t index : indices_) {
        lower_ = glm::min(lower_, positions_[index]);
        upper_ = glm::max(upper_, positions_[index]);
    }
}

}  // namespace verglas
