// SPDX-License-Identifier: GPL-3.0-or-later
// OpenGL objects as values that clean up behind themselves; to be used on the GL thread only.
#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "core/gl/api.h"

namespace verglas::gl {

// A name of an OpenGL object and how to delete it.
template <void (*destroy)(GLuint)>
class Handle {
  public:
    Handle() = default;
    explicit Handle(GLuint id) : id_(id) {}
    ~Handle() { reset(); }
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;

    GLuint id() const { return id_; }
    explicit operator bool() const { return id_ != 0; }

  private:
    void reset() {
        if (id_ != 0) destroy(id_);
    }

    GLuint id_ = 0;
};

inline void delete_texture(GLuint id) { glDeleteTextures(1, &id); }
inline void delete_buffer(GLuint id) { glDeleteBuffers(1, &id); }
inline void delete_framebuffer(GLuint id) { glDeleteFramebuffers(1, &id); }
inline void delete_vertex_array(GLuint id) { glDeleteVertexArrays(1, &id); }
inline void delete_query(GLuint id) { glDeleteQueries(1, &id); }

using Buffer = Handle<delete_buffer>;
using VertexArray = Handle<delete_vertex_array>;
using Query = Handle<delete_query>;

// A two-dimensional texture or an array of them.
class Texture : public Handle<delete_texture> {
  public:
    Texture() = default;
    // filter: GL_NEAREST or GL_LINEAR. levels: 1, or the number of mipmap levels. layers: 0 for a plain
    // texture. Throws Error where the driver has no room.
    Texture(GLenum format, int width, int height, GLenum filter, int levels = 1, int layers = 0);

    int width() const { return width_; }
    int height() const { return height_; }
    int levels() const { return levels_; }

  private:
    int width_ = 0;
    int height_ = 0;
    int levels_ = 0;
};

// Levels of a picture's mipmaps, down to one texel.
int mipmap_levels(int width, int height);

// Storage that does not change. data may be null.
Buffer make_buffer(std::size_t size, const void* data, GLbitfield flags = 0);

// Colour attachments in their order, and a depth attachment. Throws Error when incomplete.
class Framebuffer : public Handle<delete_framebuffer> {
  public:
    struct Attachment {
        const Texture& texture;
        int level = 0;
        int layer = -1;  // of an array
    };
    Framebuffer() = default;
    explicit Framebuffer(std::initializer_list<Attachment> colors, const Texture* depth = nullptr);
};

VertexArray make_vertex_array();

}  // namespace verglas::gl
