// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/gl/objects.h"
#include "core/gl/program.h"

namespace verglas {

// The picture of all that isn't a pane, at all scales, for what is seen through panes. Made for scenes with
// both.
class BehindPass {
  public:
    BehindPass();
    // From the nearest fronts and what is shaded of them, before panes are drawn.
    void build(const gl::Texture& front_faces, const gl::Texture& shaded);
    // As shaders/behind.glsl reads them.
    const gl::Texture& radiance() const { return radiance_; }
    const gl::Texture& depth() const { return depth_; }

  private:
    gl::Program program_;
    gl::VertexArray empty_;
    gl::Texture radiance_;
    gl::Texture depth_;
    gl::Framebuffer framebuffer_;  // of the finest level
};

}  // namespace verglas
