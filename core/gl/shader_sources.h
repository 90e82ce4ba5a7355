// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace verglas::gl {

// Text of a file below shaders/, by its path there, such as "lib/lobe.glsl". Throws Error if there is none.
std::string_view shader_source(std::string_view path);

}  // namespace verglas::gl
