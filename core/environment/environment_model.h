// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "core/environment/filtered_map.h"
#include "core/material/model.h"

namespace verglas::model {

// The part of shaders/lib that reads the prefiltered environment, for C++. Any number of threads may look up
// at the same time.
class EnvironmentModel {
  public:
    explicit EnvironmentModel(std::shared_ptr<const FilteredEnvironmentMap> environment)
        : environment_(std::move(environment)) {}

    // Mean radiance under a lobe of the given spread, 0 … 1, about a unit direction in the map's frame.
    vec3 environment_radiance(const vec3& direction, float spread) const {
        return Lookup{*environment_}.environment_radiance(direction, spread);
    }

  private:
    // Its functions aren't const, for which GLSL has no word.
    struct Lookup {
        const FilteredEnvironmentMap& environment;

        // Bilinear, as GL_LINEAR with GL_REPEAT across and GL_CLAMP_TO_EDGE upward.
        vec3 sample_environment_map(vec2 uv) const {
            const int width = environment.map->width();
            const int height = environment.map->height();
            const float x = uv.x * static_cast<float>(width) - 0.5F;
            const float y = uv.y * static_cast<float>(height) - 0.5F;
            const int i = static_cast<int>(floor(x));
            const int j = static_cast<int>(floor(y));
            const int left = i < 0 ? width - 1 : std::min(i, width - 1);
            const int right = left + 1 < width ? left + 1 : 0;
            const vec3* lower = &environment.map->pixels()[std::size_t(std::max(j, 0)) * width];
            const vec3* upper = &environment.map->pixels()[std::size_t(std::min(j + 1, height - 1)) * width];
            const float t = x - static_cast<float>(i);
            return mix(mix(lower[left], lower[right], t), mix(upper[left], upper[right], t),
                       y - static_cast<float>(j));
        }

        // Bilinear, with texels at the corners of the lattice.
        vec3 sample_environment_level(int level, vec2 uv) const {
            const EnvironmentLattice& lattice = environment.levels[level];
            const float x = uv.x * static_cast<float>(lattice.level.columns);
            const float y = uv.y * static_cast<float>(lattice.level.intervals);
            const int i = std::clamp(static_cast<int>(x), 0, lattice.level.columns - 1);
            const int j = std::clamp(static_cast<int>(y), 0, lattice.level.intervals - 1);
            const vec4* lower = lattice.row(j) + i;
            const vec4* upper = lattice.row(j + 1) + i;
            const float t = x - static_cast<float>(i);
            return vec3(
                mix(mix(lower[0], lower[1], t), mix(upper[0], upper[1], t), y - static_cast<float>(j)));
        }

        float environment_kappa_0() const { return environment.levels.front().level.kappa; }
        int environment_last_level() const { return static_cast<int>(environment.levels.size()) - 1; }

#include "shaders/lib/environment_lookup.glsl"
    };

    std::shared_ptr<const FilteredEnvironmentMap> environment_;
};

}  // namespace verglas::model
