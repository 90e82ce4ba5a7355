// SPDX-License-Identifier: GPL-3.0-or-later
// The model of shaders/lib as either device runs it, for tests of the one that hold for the other, too.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "core/gl/api.h"
#include "core/gl/thread.h"
#include "core/material/lobe_model.h"
#include "core/material/model.h"

namespace verglas {

namespace model {

// The functions of model_questions.glsl as C++.
struct Questions {
    const LobeModel& lobes;

    Lobe reflected_lobe(int table, float eta, float roughness, const vec3& d, const vec3& n) const {
        return lobes.reflected_lobe(table, eta, roughness, d, n);
    }
    Lobe refracted_lobe(int table, float eta, float roughness, const vec3& d, const vec3& n, int tir) const {
        return lobes.refracted_lobe(table, eta, roughness, d, n, tir);
    }

#include "tests/core/model_questions.glsl"
};

}  // namespace model

using Question = model::Questions::Question;
using Answer = model::Questions::Answer;

// The one context of all tests.
gl::Thread& gl_thread();

// A function `Answer function(Question)` of a GLSL text, where both are structs of vec4s or vec4 itself.
struct ComputeFunction {
    std::string text;  // from #version on
    std::string question;
    std::string answer;
    std::string name;
};

// Calls it on the GPU for `count` questions. bind: sets the uniforms of the program that it gets; on the GL
// thread. Throws Error with the compiler's log.
void compute(const ComputeFunction& function, const std::function<void(GLuint program)>& bind, int count,
             const void* questions, std::size_t question_size, void* answers, std::size_t answer_size);

template <typename Out, typename In>
std::vector<Out> compute(const ComputeFunction& function, const std::function<void(GLuint program)>& bind,
                         const std::vector<In>& questions) {
    std::vector<Out> answers(questions.size());
    compute(function, bind, static_cast<int>(questions.size()), questions.data(), sizeof(In), answers.data(),
            sizeof(Out));
    return answers;
}

// A lobe of answer_of_lobe.
inline model::Lobe lobe_of(const Answer& answer) {
    model::Lobe lobe;
    lobe.energy = answer.a.w;
    lobe.spread = answer.b.x;
    lobe.direction = glm::vec3(answer.a);
    return lobe;
}

enum class Device { Cpu, OpenGl };

// A function of model_questions.glsl.
struct ModelFunction {
    const char* name;
    Answer (model::Questions::*on_cpu)(Question);
};
#define MODEL_FUNCTION(name) (ModelFunction{#name, &model::Questions::name})

// A test that runs on both devices.
class OnDevice : public testing::TestWithParam<Device> {
  protected:
    // Asks all questions at once. tables: those that the function looks up.
    static std::vector<Answer> ask(const ModelFunction& function, const std::vector<Question>& questions,
                                   const std::vector<LobeSlice>& tables = {});
    static Answer ask(const ModelFunction& function, const Question& question) {
        return ask(function, std::vector{question}).front();
    }
};

// How tests of both devices are named: Devices/NAME/Cpu and so on.
#define ON_BOTH_DEVICES(suite)                                                             \
    INSTANTIATE_TEST_SUITE_P(Devices, suite, testing::Values(Device::Cpu, Device::OpenGl), \
                             [](const auto& test) { return test.param == Device::Cpu ? "Cpu" : "OpenGl"; })

}  // namespace verglas
