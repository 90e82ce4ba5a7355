// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "core/environment/level_plan.h"
#include "core/gl/objects.h"
#include "core/gl/program.h"
#include "core/scene/environment_map.h"

namespace verglas {

// An environment on the GPU: the map as it is, and its levels.
struct FilteredEnvironment {
    std::shared_ptr<const EnvironmentMap> map;
    gl::Texture raw;    // the map itself, repeated in u
    gl::Texture atlas;  // all levels above each other
    std::vector<EnvironmentLevel> levels;
};

// Prefilters environment maps on the GPU, by core/environment/level_plan.h. Lives on the GL thread.
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
