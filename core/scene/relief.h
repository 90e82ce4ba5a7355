// SPDX-License-Identifier: GPL-3.0-or-later
// Textures that bend a surface's normals, where it itself stays as it is: a normal map, then a bump map, with
// the meaning of Blender's nodes Normal Map and Bump (shaders/lib/relief.glsl).
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "core/scene/texture.h"

namespace verglas {

// What the axes of a normal map's colours are: tangent, bitangent and normal, or X, Y and Z.
enum class NormalSpace { Tangent, Object, World };

struct NormalMap {
    std::shared_ptr<const VectorTexture> texture;  // colours 0 … 1 for -1 … 1; may be null
    NormalSpace space = NormalSpace::Tangent;
    float steepness = 1.0F;  // factor of the map's slopes in tangent space; 1 in others
    float strength = 1.0F;   // 0: the mesh's own normals, 1: the map's

    bool operator==(const NormalMap&) const = default;
};

struct BumpMap {
    std::shared_ptr<const Texture> height;  // may be null
    float strength = 1.0F;                  // 0: the normals as they were, 1: those of the heights
    float distance = 1.0F;                  // in world units, of a height of 1; below 0 it goes inward

    bool operator==(const BumpMap&) const = default;
};

struct Relief {
    NormalMap normals;
    BumpMap bump;

    bool operator==(const Relief&) const = default;
    bool empty() const { return !normals.texture && !bump.height; }
};

// Where a mesh has the textures of its relief. One a vertex, or empty, where it has none.
struct ReliefCoordinates {
    std::vector<glm::vec2> normal_uvs;
    std::vector<glm::vec4> tangents;  // xyz: unit, object space, along the u that the normal map was made
                                      // for; w: 1 where its v goes along normal x tangent, -1 where against
    std::vector<glm::vec2> height_uvs;

    bool has(const NormalMap& map) const {
        return !normal_uvs.empty() && (map.space != NormalSpace::Tangent || !tangents.empty());
    }
    bool has(const BumpMap&) const { return !height_uvs.empty(); }
};

}  // namespace verglas
