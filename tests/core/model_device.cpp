// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/core/model_device.h"

#include <fstream>
#include <iterator>

#include "core/error.h"
#include "core/gl/objects.h"
#include "core/gl/program.h"
#include "core/gl/shader_sources.h"

namespace verglas {
namespace {

void expect_linked(GLuint program) {
    GLint good = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &good);
    if (good == GL_TRUE) return;
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), &length, log.data());
    throw Error(log.substr(0, length));
}

std::string model_text() {
    std::string text = gl::full_source("lobes.glsl");
    for (const char* file :
         {"lib/analytic_lobe.glsl", "lib/bundle.glsl", "lib/local_light.glsl", "lib/vmf_masking.glsl",
          "lib/specular.glsl", "lib/depth_mip.glsl", "lib/environment.glsl", "lib/relief.glsl"})
        text += gl::shader_source(file);
    std::ifstream questions(VERGLAS_TESTS_FOLDER "/model_questions.glsl");
    return text.append(std::istreambuf_iterator<char>(questions), {});
}

// As MaterialCache does.
gl::Texture upload(const std::vector<LobeSlice>& tables) {
    gl::Texture texture(GL_RGBA32F, model::LOBE_COSINES, model::LOBE_ROUGHNESSES, GL_LINEAR, 1,
                        static_cast<int>(tables.size()));
    for (int layer = 0; layer < static_cast<int>(tables.size()); ++layer)
        glTextureSubImage3D(texture.id(), 0, 0, 0, layer, model::LOBE_COSINES, model::LOBE_ROUGHNESSES, 1,
                            GL_RGBA, GL_FLOAT, tables[layer].data());
    return texture;
}

}  // namespace

gl::Thread& gl_thread() {
    static gl::Thread thread;
    return thread;
}

void compute(const ComputeFunction& function, const std::function<void(GLuint program)>& bind, int count,
             const void* questions, std::size_t question_size, void* answers, std::size_t answer_size) {
    const std::string text = function.text + "layout(local_size_x = 64) in;\n" +
                             "layout(std430, binding = 0) readonly buffer Questions { " + function.question +
                             " questions[]; };\n" +
                             "layout(std430, binding = 1) writeonly buffer Answers { " + function.answer +
                             " answers[]; };\n" +
                             "void main() {\n"
                             "    uint i = gl_GlobalInvocationID.x;\n"
                             "    if (i < questions.length()) answers[i] = " +
                             function.name + "(questions[i]);\n}\n";
    gl_thread().run([&] {
        const char* pointer = text.c_str();
        const gl::Handle<gl::delete_program> program(glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &pointer));
        expect_linked(program.id());
        bind(program.id());
        const gl::Buffer in = gl::make_buffer(count * question_size, questions);
        const gl::Buffer out = gl::make_buffer(count * answer_size, nullptr);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out.id());
        glUseProgram(program.id());
        glDispatchCompute((static_cast<GLuint>(count) + 63) / 64, 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(out.id(), 0, static_cast<GLsizeiptr>(count * answer_size), answers);
        glUseProgram(0);
    });
}

std::vector<Answer> OnDevice::ask(const ModelFunction& function, const std::vector<Question>& questions,
                                  const std::vector<LobeSlice>& tables) {
    if (GetParam() == Device::Cpu) {
        const model::LobeModel lobes(tables);
        std::vector<Answer> answers;
        for (const Question& question : questions)
            answers.push_back((model::Questions{lobes}.*function.on_cpu)(question));
        return answers;
    }
    gl::Texture texture;
    const auto bind = [&](GLuint program) {
        if (tables.empty()) return;
        texture = upload(tables);
        glBindTextureUnit(0, texture.id());
        glProgramUniform1i(program, glGetUniformLocation(program, "lobe_tables"), 0);
    };
    auto answers = compute<Answer>({model_text(), "Question", "Answer", function.name}, bind, questions);
    gl_thread().run([&] { texture = gl::Texture(); });
    return answers;
}

}  // namespace verglas
