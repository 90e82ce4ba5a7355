// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/gl/objects.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/error.h"

namespace verglas::gl {
namespace {

GLuint create_texture(bool array) {
    GLuint id = 0;
    glCreateTextures(array ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D, 1, &id);
    return id;
}

GLuint create_framebuffer() {
    GLuint id = 0;
    glCreateFramebuffers(1, &id);
    return id;
}

// Errors that were reported before, by whatever, are not the next call's.
void forget_errors() {
    while (glGetError() != GL_NO_ERROR) {
    }
}

}  // namespace

Texture::Texture(GLenum format, int width, int height, GLenum filter, int levels, int layers)
    : Handle(create_texture(layers > 0)), width_(width), height_(height), levels_(levels) {
    forget_errors();
    if (layers > 0)
        glTextureStorage3D(id(), levels, format, width, height, layers);
    else
        glTextureStorage2D(id(), levels, format, width, height);
    if (glGetError() != GL_NO_ERROR)
        throw Error("The graphics driver has no room for a picture of " + std::to_string(width) + " x " +
                    std::to_string(height) + " pixels.");
    const GLenum minify = levels == 1           ? filter
                          : filter == GL_LINEAR ? GL_LINEAR_MIPMAP_LINEAR
                                                : GL_NEAREST_MIPMAP_NEAREST;
    glTextureParameteri(id(), GL_TEXTURE_MIN_FILTER, static_cast<GLint>(minify));
    glTextureParameteri(id(), GL_TEXTURE_MAG_FILTER, static_cast<GLint>(filter));
    glTextureParameteri(id(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(id(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

int mipmap_levels(int width, int height) {
    return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(width, height))));
}

Buffer make_buffer(std::size_t size, const void* data, GLbitfield flags) {
    GLuint id = 0;
    glCreateBuffers(1, &id);
    Buffer buffer(id);
    forget_errors();
    glNamedBufferStorage(id, static_cast<GLsizeiptr>(size), data, flags);
    if (glGetError() != GL_NO_ERROR)
        throw Error("The graphics driver has no room for a buffer of " + std::to_string(size) + " bytes.");
    return buffer;
}

Framebuffer::Framebuffer(std::initializer_list<Attachment> colors, const Texture* depth)
    : Handle(create_framebuffer()) {
    std::vector<GLenum> draw_buffers;
    for (const Attachment& color : colors) {
        const GLenum attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(draw_buffers.size());
        if (color.layer >= 0)
            glNamedFramebufferTextureLayer(id(), attachment, color.texture.id(), color.level, color.layer);
        else
            glNamedFramebufferTexture(id(), attachment, color.texture.id(), color.level);
        draw_buffers.push_back(attachment);
    }
    glNamedFramebufferDrawBuffers(id(), static_cast<GLsizei>(draw_buffers.size()), draw_buffers.data());
    if (depth != nullptr) glNamedFramebufferTexture(id(), GL_DEPTH_ATTACHMENT, depth->id(), 0);
    if (glCheckNamedFramebufferStatus(id(), GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error("The graphics driver can't render into the formats that Verglas needs.");
}

VertexArray make_vertex_array() {
    GLuint id = 0;
    glCreateVertexArrays(1, &id);
    return VertexArray(id);
}

}  // namespace verglas::gl
