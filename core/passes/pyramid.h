// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/gl/objects.h"
#include "core/gl/program.h"

namespace verglas {

// The pyramid over the back faces (de Rousiers et al. 2012, second pass): distributions of normals and ranges
// of depth at all scales. Made for the paper's transport and for marching.
class PyramidPass {
  public:
    PyramidPass();
    void build(const gl::Texture& back_faces);
    const gl::Texture& normals() const { return normals_; }
    const gl::Texture& depths() const { return depths_; }

  private:
    void draw(const gl::Program& program, int level) const;

    gl::Program base_;
    gl::Program reduce_;
    gl::VertexArray empty_;
    gl::Texture normals_;
    gl::Texture depths_;
    std::vector<gl::Framebuffer> framebuffers_;  // one a level
};

}  // namespace verglas
