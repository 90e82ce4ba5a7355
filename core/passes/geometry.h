// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "core/gl/objects.h"
#include "core/gl/program.h"
#include "core/passes/view.h"

namespace verglas {

// What a geometry buffer holds of roughness: nothing, each pixel's (of both sides of a thin layer), or the
// shares in it of four or eight classes.
enum class RoughnessData { None, Values, Classes4, Classes8 };

// Layers of an array that hold four classes each.
inline int class_layers(RoughnessData data) {
    return data == RoughnessData::Classes8 ? 2 : data == RoughnessData::Classes4 ? 1 : 0;
}

// What holds the classes of several geometry buffers, at all scales: an array of class_layers() layers for
// each. Shares are times coverage. None where data is not of classes.
gl::Texture make_class_pyramid(glm::ivec2 size, RoughnessData data, int buffers);

// A geometry buffer: normal, depth and index of one layer of faces (shaders/geometry_buffer.glsl), and their
// roughness where textures make it vary.
class GeometryBuffer {
  public:
    // Classes are held in the pyramid, which must outlive it, as those of the buffer of this number.
    explicit GeometryBuffer(glm::ivec2 size, RoughnessData roughness_data = RoughnessData::None,
                            const gl::Texture& class_pyramid = {}, int number = 0);
    const gl::Texture& texels() const { return texels_; }
    RoughnessData roughness_data() const { return roughness_data_; }
    // Each pixel's, in units of MAX_ROUGHNESS: of the side that is seen, and of a thin layer's other one.
    const gl::Texture& roughness() const { return roughness_; }
    const gl::Framebuffer& framebuffer() const { return framebuffer_; }

  private:
    RoughnessData roughness_data_;
    gl::Texture texels_;
    gl::Texture roughness_;
    gl::Texture depth_;
    gl::Framebuffer framebuffer_;
};

enum class Faces { NearestFront, FarthestFront, NearestBack, FarthestBack };

// What the objects' surfaces are made of.
struct Surfaces {
    const std::vector<Material>& materials;
    const TextureCache& textures;
    const ReliefCache& reliefs;
};

// Rasterises objects into geometry buffers (de Rousiers et al. 2012, first pass, has nearest front and
// farthest back faces). Thin layers count as front faces alone, from both sides.
class GeometryPass {
  public:
    // Empties a part of a buffer.
    void clear(const GeometryBuffer& buffer, Faces faces, const Rect& rect) const;
    // Adds the objects of a group. Front faces carry the group's number beside that of their material.
    void draw(const GeometryBuffer& buffer, Faces faces, const View& view, const ViewGroup& group, int number,
              const Surfaces& surfaces);

  private:
    const gl::Program& program(RoughnessData data, bool relief);
    static void set_roughness(const gl::Program& program, const Material& material,
                              const TextureCache& textures);
    static void set_inner_roughness(const gl::Program& program, const Material& material,
                                    const TextureCache& textures);

    static void set_relief(const gl::Program& program, const Relief& relief, const Mesh& mesh,
                           const ReliefCache& reliefs);

    std::map<std::pair<RoughnessData, bool>, gl::Program> programs_;  // by data and whether there is relief
};

}  // namespace verglas
