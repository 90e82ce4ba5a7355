// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/behind.h"

#include <algorithm>
#include <bit>

namespace verglas {

BehindPass::BehindPass()
    : program_("full_screen.vert.glsl", "behind.frag.glsl"), empty_(gl::make_vertex_array()) {}

void BehindPass::build(const ShadingInputs& inputs, const gl::Texture& shaded) {
    const glm::ivec2 size = inputs.view.size;
    if (glm::ivec2(radiance_.width(), radiance_.height()) != size) {
        const int levels = static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(size.x, size.y))));
        radiance_ = gl::Texture(GL_RGBA32F, size.x, size.y, GL_LINEAR, levels);
        depth_ = gl::Texture(GL_R32F, size.x, size.y, GL_LINEAR, levels);
        framebuffer_ = gl::Framebuffer({{radiance_}, {depth_}});
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    glViewport(0, 0, size.x, size.y);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    program_.use();
    glBindTextureUnit(0, inputs.front.texels().id());
    glBindTextureUnit(1, shaded.id());
    program_.set("front_faces", 0);
    program_.set("shaded", 1);
    gl::draw_full_screen(empty_);
    glGenerateTextureMipmap(radiance_.id());
    glGenerateTextureMipmap(depth_.id());
}

}  // namespace verglas
