// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/behind.h"

namespace verglas {

BehindPass::BehindPass()
    : program_("full_screen.vert.glsl", "behind.frag.glsl"), empty_(gl::make_vertex_array()) {}

void BehindPass::build(const gl::Texture& front_faces, const gl::Texture& shaded) {
    const int width = front_faces.width();
    const int height = front_faces.height();
    if (radiance_.width() != width || radiance_.height() != height) {
        const int levels = gl::mipmap_levels(width, height);
        radiance_ = gl::Texture(GL_RGBA32F, width, height, GL_LINEAR, levels);
        depth_ = gl::Texture(GL_R32F, width, height, GL_LINEAR, levels);
        framebuffer_ = gl::Framebuffer({{radiance_}, {depth_}});
    }
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
    glViewport(0, 0, width, height);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    program_.use();
    glBindTextureUnit(0, front_faces.id());
    glBindTextureUnit(1, shaded.id());
    program_.set("front_faces", 0);
    program_.set("shaded", 1);
    gl::draw_full_screen(empty_);
    glGenerateTextureMipmap(radiance_.id());
    glGenerateTextureMipmap(depth_.id());
}

}  // namespace verglas
