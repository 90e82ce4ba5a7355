// SPDX-License-Identifier: GPL-3.0-or-later
// The model of shaders/lib as C++: the same functions that the GPU runs.
#pragma once

#include "core/math/glsl.h"

namespace verglas::model {

// Each file may use those before it.
// clang-format off
#include "shaders/lib/constants.glsl"
#include "shaders/lib/fresnel.glsl"
#include "shaders/lib/microfacet.glsl"
#include "shaders/lib/coverage.glsl"
#include "shaders/lib/spherical_gaussian.glsl"
#include "shaders/lib/lobe.glsl"
#include "shaders/lib/spherical_warping.glsl"
#include "shaders/lib/analytic_lobe.glsl"
#include "shaders/lib/bundle.glsl"
#include "shaders/lib/local_light.glsl"
#include "shaders/lib/vmf_masking.glsl"
#include "shaders/lib/pane.glsl"
#include "shaders/lib/coated.glsl"
#include "shaders/lib/specular.glsl"
#include "shaders/lib/depth_mip.glsl"
#include "shaders/lib/environment.glsl"
#include "shaders/lib/relief.glsl"
// clang-format on

}  // namespace verglas::model
