// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/gl/program.h"

#include <glm/gtc/type_ptr.hpp>
#include <set>

#include "core/error.h"
#include "core/gl/shader_sources.h"

namespace verglas::gl {
namespace {

void append_file(std::string_view path, std::set<std::string, std::less<>>& seen, std::string& text) {
    if (!seen.emplace(path).second) return;
    constexpr std::string_view directive = "#include \"";
    std::string_view rest = shader_source(path);
    while (!rest.empty()) {
        const std::size_t end = rest.find('\n');
        const std::string_view line = rest.substr(0, end);
        rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
        if (line.substr(0, directive.size()) == directive)
            append_file(line.substr(directive.size(), line.size() - directive.size() - 1), seen, text);
        else
            text.append(line).append("\n");
    }
}

GLuint compile(GLenum stage, std::string_view file, const std::vector<std::string>& defines) {
    const std::string text = full_source(file, defines);
    const GLuint shader = glCreateShader(stage);
    const char* pointer = text.c_str();
    glShaderSource(shader, 1, &pointer, nullptr);
    glCompileShader(shader);
    GLint good = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (good == GL_TRUE) return shader;
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
    glDeleteShader(shader);
    throw Error("The graphics driver can't compile the shader " + std::string(file) + ": " +
                log.substr(0, length));
}

}  // namespace

std::string full_source(std::string_view file, const std::vector<std::string>& defines) {
    std::string text = "#version 450 core\n#define SHARED\n";
    for (const std::string& define : defines) text += "#define " + define + "\n";
    std::set<std::string, std::less<>> seen;
    append_file(file, seen, text);
    return text;
}

Program::Program(std::string_view vertex_file, std::string_view fragment_file,
                 const std::vector<std::string>& defines)
    : Handle(glCreateProgram()) {
    for (const auto& [stage, file] :
         {std::pair(GL_VERTEX_SHADER, vertex_file), std::pair(GL_FRAGMENT_SHADER, fragment_file)}) {
        const GLuint shader = compile(stage, file, defines);
        glAttachShader(id(), shader);
        glDeleteShader(shader);  // lives on until the program is gone
    }
    glLinkProgram(id());
    GLint good = GL_FALSE;
    glGetProgramiv(id(), GL_LINK_STATUS, &good);
    if (good == GL_TRUE) return;
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(id(), static_cast<GLsizei>(log.size()), &length, log.data());
    throw Error("The graphics driver can't link the shader " + std::string(fragment_file) + ": " +
                log.substr(0, length));
}

void Program::set(const char* name, int value) const { glProgramUniform1i(id(), location(name), value); }
void Program::set(const char* name, float value) const { glProgramUniform1f(id(), location(name), value); }
void Program::set(const char* name, const glm::vec2& value) const {
    glProgramUniform2fv(id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::vec3& value) const {
    glProgramUniform3fv(id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::vec4& value) const {
    glProgramUniform4fv(id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::ivec2& value) const {
    glProgramUniform2iv(id(), location(name), 1, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::mat3& value) const {
    glProgramUniformMatrix3fv(id(), location(name), 1, GL_FALSE, glm::value_ptr(value));
}
void Program::set(const char* name, const glm::mat4& value) const {
    glProgramUniformMatrix4fv(id(), location(name), 1, GL_FALSE, glm::value_ptr(value));
}

void draw_full_screen(const VertexArray& empty) {
    glBindVertexArray(empty.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace verglas::gl
