// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "core/environment/level_plan.h"
#include "core/scene/environment_map.h"

namespace verglas {

// A level of a prefiltered environment and its texels.
struct EnvironmentLattice {
    EnvironmentLevel level;
    std::vector<glm::vec4> texels;  // (columns + 1) x (intervals + 1), row 0 at the bottom: linear RGB, 1

    const glm::vec4* row(int y) const { return &texels[std::size_t(y) * (level.columns + 1)]; }
};

// An environment for the CPU: the map as it is, and its levels from the sharpest to the bluntest.
struct FilteredEnvironmentMap {
    std::shared_ptr<const EnvironmentMap> map;
    std::vector<EnvironmentLattice> levels;
};

// Prefilters a map with all threads of TBB's current arena; may be called from any thread. The levels are
// those of EnvironmentFilter, whatever the number of threads. A map 1024 texels wide takes 0.3 s of one core
// and 20 MB of levels, one of 2048 and more 1.5 s and 80 MB. map: not null; kept as it is, whatever its size.
std::shared_ptr<const FilteredEnvironmentMap> filter_environment(std::shared_ptr<const EnvironmentMap> map);

}  // namespace verglas
