// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/gl/debug.h"

#include <utility>

#include "core/error.h"
#include "core/gl/api.h"

namespace verglas::gl {
namespace {

// The first fault since the last check; one context a thread.
thread_local std::string fault;

// Runs on the thread of the context, since GL_DEBUG_OUTPUT_SYNCHRONOUS is on. Must not throw through the
// driver.
void APIENTRY on_message(GLenum /*source*/, GLenum /*type*/, GLuint /*id*/, GLenum severity, GLsizei length,
                         const GLchar* message, const void* /*user*/) {
    if (severity == GL_DEBUG_SEVERITY_HIGH && fault.empty())
        fault.assign(message, static_cast<std::size_t>(length));
}

}  // namespace

void install_debug_callback() {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_message, nullptr);
}

PassScope::PassScope(std::string name) : name_(std::move(name)) {
    fault.clear();
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, static_cast<GLsizei>(name_.size()), name_.c_str());
}

PassScope::~PassScope() { glPopDebugGroup(); }

void PassScope::check() const {
    if (!fault.empty())
        throw Error("The graphics driver reports a fault in the pass '" + name_ + "': " + fault);
}

}  // namespace verglas::gl
