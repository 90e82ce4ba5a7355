// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/gl/context.h"

#include <EGL/eglext.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/error.h"
#include "core/gl/api.h"

namespace verglas::gl {
namespace {

template <typename Function>
Function egl_function(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

bool is_software(EGLDeviceEXT device) {
    const auto query = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    const char* extensions = query != nullptr ? query(device, EGL_EXTENSIONS) : nullptr;
    return extensions != nullptr && std::strstr(extensions, "EGL_MESA_device_software") != nullptr;
}

// All devices in the order in which they are tried; empty where EGL can't list them.
std::vector<EGLDeviceEXT> devices() {
    const auto query = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    std::array<EGLDeviceEXT, 32> all{};
    EGLint count = 0;
    if (query == nullptr || query(static_cast<EGLint>(all.size()), all.data(), &count) != EGL_TRUE) return {};
    std::vector<EGLDeviceEXT> sorted(all.begin(), all.begin() + count);
    if (const char* choice = std::getenv("VERGLAS_EGL_DEVICE"); choice != nullptr && *choice != '\0') {
        char* end = nullptr;
        const long number = std::strtol(choice, &end, 10);
        if (*end != '\0' || number < 0 || number >= count)
            throw Error("VERGLAS_EGL_DEVICE is '" + std::string(choice) +
                        "', but this machine's EGL devices are 0 to " + std::to_string(count - 1) + ".");
        return {sorted[number]};
    }
    std::stable_partition(sorted.begin(), sorted.end(),
                          [](EGLDeviceEXT device) { return !is_software(device); });
    return sorted;
}

// Displays to try: one a device, then Mesa's surfaceless platform.
std::vector<EGLDisplay> displays() {
    const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    std::vector<EGLDisplay> result;
    if (get_display == nullptr) return result;
    for (EGLDeviceEXT device : devices())
        result.push_back(get_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr));
    if (result.empty())
        result.push_back(get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    return result;
}

EGLContext create_context(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE)
        return EGL_NO_CONTEXT;
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return EGL_NO_CONTEXT;
    constexpr std::array<EGLint, 13> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                                   4,
                                                   EGL_CONTEXT_MINOR_VERSION,
                                                   5,
                                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                   EGL_CONTEXT_OPENGL_DEBUG,
                                                   EGL_TRUE,
                                                   EGL_NONE};
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) return EGL_NO_CONTEXT;
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE) return context;
    eglDestroyContext(display, context);
    return EGL_NO_CONTEXT;
}

}  // namespace

Context::Context() {
    for (EGLDisplay display : displays()) {
        context_ = create_context(display);
        if (context_ == EGL_NO_CONTEXT) continue;
        display_ = display;
        device_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
        return;
    }
    throw Error(
        "Verglas found no OpenGL 4.5 through EGL: install a graphics driver, or Mesa's software renderer "
        "(on Debian the packages libegl1 and libgl1-mesa-dri).");
}

// The display stays initialised: other code of the process may use the same one.
Context::~Context() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglReleaseThread();
}

}  // namespace verglas::gl
