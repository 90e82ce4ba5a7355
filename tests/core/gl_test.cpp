// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <stdexcept>

#include "core/error.h"
#include "core/gl/debug.h"
#include "core/gl/objects.h"
#include "core/gl/program.h"
#include "core/gl/thread.h"

namespace verglas {
namespace {

// A user loses: the word of which step of a render the driver could not do, in place of a wrong picture.
TEST(Gl, FaultNamesThePass) {
    gl::Thread thread;
    try {
        thread.run([] {
            const gl::PassScope scope("test pass");
            glBindTextureUnit(0, 123456);
            scope.check();
        });
        FAIL() << "no fault was reported";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("test pass"), std::string::npos) << error.what();
    }
    // The next pass begins anew.
    thread.run([] {
        const gl::PassScope scope("next pass");
        scope.check();
    });
}

// A user loses: Blender, which an exception on another thread would end.
TEST(Gl, ExceptionsReachTheCaller) {
    gl::Thread thread;
    EXPECT_THROW(thread.run([] { throw std::out_of_range("mine"); }), std::out_of_range);
    EXPECT_EQ(thread.run([] { return 7; }), 7);
}

// A user loses: several renderers in one process, as the viewport and a final frame may be.
TEST(Gl, SeveralContextsLiveSideBySide) {
    gl::Thread first;
    gl::Thread second;
    const auto make = [] { return gl::Texture(GL_RGBA8, 16, 16, GL_NEAREST).width(); };
    EXPECT_EQ(first.run(make), 16);
    EXPECT_EQ(second.run(make), 16);
}

// A developer loses: the file's name and the compiler's words for a shader that doesn't compile.
TEST(Gl, ShaderErrorsNameTheFile) {
    gl::Thread thread;
    const auto build = [] { gl::Program("full_screen.vert.glsl", "refraction.frag.glsl", {"Lobe 3"}); };
    try {
        thread.run(build);
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("refraction.frag.glsl"), std::string::npos);
    }
}

}  // namespace
}  // namespace verglas
