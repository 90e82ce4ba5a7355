// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/gl/objects.h"
#include "core/gl/program.h"
#include "core/passes/view.h"

namespace verglas {

// A geometry buffer: normal, depth and index of one layer of faces (shaders/geometry_buffer.glsl), and their
// roughness where textures make it vary.
class GeometryBuffer {
  public:
    explicit GeometryBuffer(glm::ivec2 size, bool with_roughness = false);
    const gl::Texture& texels() const { return texels_; }
    bool has_roughness() const { return static_cast<bool>(roughness_); }
    const gl::Texture& roughness() const { return roughness_; }
    const gl::Framebuffer& framebuffer() const { return framebuffer_; }

  private:
    gl::Texture texels_;
    gl::Texture roughness_;  // 0 … 1
    gl::Texture depth_;
    gl::Framebuffer framebuffer_;
};

enum class Faces { NearestFront, FarthestFront, NearestBack, FarthestBack };

// What the scene's materials look like, for shaders.
struct Surfaces {
    const std::vector<Material>& materials;
    const MaterialCache& buffer;
    const TextureCache& textures;
};

// Rasterises objects into geometry buffers (de Rousiers et al. 2012, first pass, has nearest front and
// farthest back faces).
class GeometryPass {
  public:
    GeometryPass();
    // Empties a part of a buffer.
    void clear(const GeometryBuffer& buffer, Faces faces, const Rect& rect) const;
    // Adds the objects of a group. Front faces carry the group's number beside that of their material.
    void draw(const GeometryBuffer& buffer, Faces faces, const View& view, const ViewGroup& group, int number,
              const Surfaces& surfaces) const;

  private:
    gl::Program plain_;
    gl::Program with_roughness_;
};

}  // namespace verglas
