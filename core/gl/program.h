// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/gl/api.h"
#include "core/gl/objects.h"

namespace verglas::gl {

inline void delete_program(GLuint id) { glDeleteProgram(id); }

// What the driver compiles for a file below shaders/. `#include "path"` is relative to shaders/; every file
// is taken once. defines: lines such as "TRANSPORT_BUNDLE", each becomes `#define TRANSPORT_BUNDLE`.
std::string full_source(std::string_view file, const std::vector<std::string>& defines = {});

// A linked program from files below shaders/. Throws Error with the file and the compiler's log.
class Program : public Handle<delete_program> {
  public:
    Program() = default;
    // defines: as for full_source.
    Program(std::string_view vertex_file, std::string_view fragment_file,
            const std::vector<std::string>& defines = {});

    void use() const { glUseProgram(id()); }
    // Values of uniforms of the program; unknown names are ignored, as OpenGL does, since the compiler may
    // have dropped them.
    void set(const char* name, int value) const;
    void set(const char* name, float value) const;
    void set(const char* name, const glm::vec2& value) const;
    void set(const char* name, const glm::vec3& value) const;
    void set(const char* name, const glm::vec4& value) const;
    void set(const char* name, const glm::ivec2& value) const;
    void set(const char* name, const glm::mat3& value) const;
    void set(const char* name, const glm::mat4& value) const;

  private:
    GLint location(const char* name) const { return glGetUniformLocation(id(), name); }
};

// Draws one triangle that covers the viewport; with shaders/full_screen.vert.glsl.
void draw_full_screen(const VertexArray& empty);

}  // namespace verglas::gl
