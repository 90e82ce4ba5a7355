// SPDX-License-Identifier: GPL-3.0-or-later
// The model of shaders/lib as C++: the same functions that the GPU runs.
#pragma once

#include "core/math/glsl.h"

namespace verglas::model {

#include "shaders/lib/constants.glsl"
#include "shaders/lib/fresnel.glsl"
#include "shaders/lib/microfacet.glsl"
#include "shaders/lib/spherical_gaussian.glsl"
// The order matters from here on.
#include "shaders/lib/lobe.glsl"
#include "shaders/lib/bundle.glsl"
#include "shaders/lib/environment.glsl"

}  // namespace verglas::model
