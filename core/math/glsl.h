// SPDX-License-Identifier: GPL-3.0-or-later
// GLSL's names from GLM, for the files of shaders/lib that C++ includes.
#pragma once

#include <glm/glm.hpp>

#define SHARED inline

namespace verglas::model {

using glm::abs;
using glm::acos;
using glm::asin;
using glm::atan;
using glm::ceil;
using glm::clamp;
using glm::cos;
using glm::cross;
using glm::dot;
using glm::exp;
using glm::exp2;
using glm::floor;
using glm::length;
using glm::log;
using glm::log2;
using glm::mat3;
using glm::max;
using glm::min;
using glm::mix;
using glm::normalize;
using glm::outerProduct;
using glm::pow;
using glm::sin;
using glm::sqrt;
using glm::vec2;
using glm::vec3;
using glm::vec4;

}  // namespace verglas::model
