// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/scene/relief.h"

namespace verglas {

// Triangles of one material slot: indices [first, first + count) of Mesh::indices.
struct MeshPart {
    int slot = 0;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

// An indexed triangle mesh with normals, sorted by material slot. Immutable.
class Mesh {
  public:
    // positions and normals: one a vertex, object space. triangles: three vertices each, counter-clockwise
    // seen from outside. slots: one a triangle, or empty for all 0. uvs: of textures of roughness, one a
    // vertex, or empty. Triangles with a vertex that isn't finite, or without area, are left out with a
    // warning; normals that are zero or not finite become the triangle's. Throws Error for arrays that don't
    // fit each other.
    Mesh(std::string name, std::vector<glm::vec3> positions, std::vector<glm::vec3> normals,
         const std::vector<glm::uvec3>& triangles, const std::vector<std::uint16_t>& slots,
         std::vector<glm::vec2> uvs = {}, ReliefCoordinates relief = {});

    const std::string& name() const { return name_; }
    const std::vector<glm::vec3>& positions() const { return positions_; }
    const std::vector<glm::vec3>& normals() const { return normals_; }
    const std::vector<glm::vec2>& uvs() const { return uvs_; }
    const ReliefCoordinates& relief() const { return relief_; }
    const std::vector<std::uint32_t>& indices() const { return indices_; }
    const std::vector<MeshPart>& parts() const { return parts_; }
    const std::vector<std::string>& warnings() const { return warnings_; }
    std::size_t triangle_count() const { return indices_.size() / 3; }
    // Corners of the bounding box of what is drawn; both 0 for a mesh without triangles.
    const glm::vec3& lower() const { return lower_; }
    const glm::vec3& upper() const { return upper_; }

  private:
    void check_count(std::size_t count, const char* what) const;
    std::vector<char> find_usable(const std::vector<glm::uvec3>& triangles);
    void sort_by_slot(const std::vector<glm::uvec3>& triangles, const std::vector<std::uint16_t>& slots,
                      const std::vector<char>& usable);
    void mend_normals();

    std::string name_;
    std::vector<glm::vec3> positions_;
    std::vector<glm::vec3> normals_;
    std::vector<glm::vec2> uvs_;
    ReliefCoordinates relief_;
    std::vector<std::uint32_t> indices_;
    std::vector<MeshPart> parts_;
    std::vector<std::string> warnings_;
    glm::vec3 lower_{0.0F};
    glm::vec3 upper_{0.0F};
};

}  // namespace verglas
