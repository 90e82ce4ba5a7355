// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "core/gl/objects.h"
#include "core/gl/program.h"
#include "core/scene/environment_map.h"

namespace verglas {

// A level of the prefiltered environment within the atlas; see shaders/lib/environment.glsl.
struct EnvironmentLevel {
    float kappa = 0.0F;
    // columns and intervals between rows of the lattice; it has one texel more in either direction.
    int columns = 0;
    int intervals = 0;
    int first_row = 0;  // of the atlas
};

// An environment on the GPU: the map as it is, and its levels.
struct FilteredEnvironment {
    std::shared_ptr<const EnvironmentMap> map;
    gl::Texture raw;    // the map itself, repeated in u
    gl::Texture atlas;  // all levels above each other
    std::vector<EnvironmentLevel> levels;
};

// Prefilters environment maps on the GPU (de Rousiers et al. 2012, section 4.1). Lives on the GL thread.
//
// Level 0 has the concentration of a Gaussian 1.5 texels wide; each level is filtered from a sharper one,
// with the kernel that A3(kappa_ab) = A3(kappa_a) A3(kappa_b) asks for.
class EnvironmentFilter {
  public:
    EnvironmentFilter();
    // Maps wider than the driver can hold are scaled down.
    FilteredEnvironment filter(std::shared_ptr<const EnvironmentMap> map) const;

  private:
    gl::Program program_;
    gl::VertexArray empty_;
};

}  // namespace verglas
