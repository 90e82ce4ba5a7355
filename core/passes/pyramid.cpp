// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/pyramid.h"

#include <algorithm>

namespace verglas {
PyramidPass::PyramidPass()
    : base_("full_screen.vert.glsl", "geometry_pyramid.frag.glsl", {"BASE"}),
      reduce_("full_screen.vert.glsl", "geometry_pyramid.frag.glsl"),
      empty_(gl::make_vertex_array()) {}

void PyramidPass::build(const gl::Texture& back_faces) {
    if (normals_.width() != back_faces.width() || normals_.height() != back_faces.height()) {
        const int width = back_faces.width();
        const int height = back_faces.height();
        const int levels = gl::mipmap_levels(width, height);
        normals_ = gl::Texture(GL_RGBA16F, width, height, GL_LINEAR, levels);
        depths_ = gl::Texture(GL_RG32F, width, height, GL_NEAREST, levels);
        framebuffers_.clear();
        for (int level = 0; level < levels; ++level)
            framebuffers_.push_back(gl::Framebuffer({{normals_, level}, {depths_, level}}));
    }
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
    glBindTextureUnit(0, back_faces.id());
    base_.set("back_faces", 0);
    draw(base_, 0);
    glBindTextureUnit(0, normals_.id());
    glBindTextureUnit(1, depths_.id());
    reduce_.set("finer_normals", 0);
    reduce_.set("finer_depths", 1);
    for (int level = 1; level < normals_.levels(); ++level) {
        // Only the level above may be read while this one is written.
        for (const gl::Texture* texture : {&normals_, &depths_}) {
            glTextureParameteri(texture->id(), GL_TEXTURE_BASE_LEVEL, level - 1);
            glTextureParameteri(texture->id(), GL_TEXTURE_MAX_LEVEL, level - 1);
        }
        draw(reduce_, level);
    }
    for (const gl::Texture* texture : {&normals_, &depths_}) {
        glTextureParameteri(texture->id(), GL_TEXTURE_BASE_LEVEL, 0);
        glTextureParameteri(texture->id(), GL_TEXTURE_MAX_LEVEL, texture->levels() - 1);
    }
}

void PyramidPass::draw(const gl::Program& program, int level) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers_[level].id());
    glViewport(0, 0, std::max(normals_.width() >> level, 1), std::max(normals_.height() >> level, 1));
    program.use();
    gl::draw_full_screen(empty_);
}

}  // namespace verglas
