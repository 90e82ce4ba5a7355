// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <EGL/egl.h>

#include <string>

namespace verglas::gl {

// An OpenGL 4.5 core context without a surface, current on the thread that makes it until it is destroyed
// there.
//
// Every EGL device is tried, hardware before software; the environment variable VERGLAS_EGL_DEVICE picks one
// by its number. Throws Error with one sentence where there is none.
class Context {
  public:
    Context();
    ~Context();
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    // The driver's name for what renders.
    const std::string& device() const { return device_; }

  private:
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
    std::string device_;
};

}  // namespace verglas::gl
