// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/gl/objects.h"
#include "core/gl/program.h"
#include "core/passes/shading.h"

namespace verglas {

// The picture of all that isn't a pane, at all scales, for what is seen through panes. Made for scenes with
// both.
class BehindPass {
  public:
    BehindPass();
    // From the shaded objects and inputs.front, before panes are drawn.
    void build(const ShadingInputs& inputs, const gl::Texture& shaded);
    BehindPanes pictures() const { return {radiance_, depth_}; }

  private:
    gl::Program program_;
    gl::VertexArray empty_;
    gl::Texture radiance_;
    gl::Texture depth_;
    gl::Framebuffer framebuffer_;  // of the finest level
};

}  // namespace verglas
