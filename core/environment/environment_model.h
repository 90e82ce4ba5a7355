// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
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
        : environment_(std::move(environment)) {
        for (const EnvironmentLattice& lattice : environment_->levels)
            levels_.push_back({lattice.texels.data(), lattice.level.columns, lattice.level.intervals,
                               spread_from_kappa(lattice.level.kappa)});
    }

    // Mean radiance under a lobe of the given spread, 0 … 1, about a unit direction in the map's frame.
    vec3 environment_radiance(const vec3& direction, float spread) const {
        return Lookup{*environment_->map, levels_}.environment_radiance(direction, spread);
    }

    // The same about many directions. spreads: as many, or one for all; radiances: as many.
    void environment_radiance(std::span<const vec3> directions, std::span<const float> spreads,
                              std::span<vec3> radiances) const {
        constexpr std::size_t width = 4;
        Lookup lookup{*environment_->map, levels_};
        // Of the last spread: often several have the same.
        float known_spread = -1.0F;
        Lookup::EnvironmentLevels known{};
        for (std::size_t first = 0; first < directions.size(); first += width) {
            // Half of the work: side by side, in vector code.
            float x[width], y[width], z[width], u[width], v[width];
            const std::size_t last = std::min(directions.size() - first, width) - 1;
            for (std::size_t i = 0; i < width; ++i) {
                const vec3& d = directions[first + std::min(i, last)];
                x[i] = d.x;
                y[i] = d.y;
                z[i] = d.z;
            }
            for (std::size_t i = 0; i < width; ++i) {
                const vec2 uv = environment_uv(vec3(x[i], y[i], z[i]));
                u[i] = uv.x;
                v[i] = uv.y;
            }
            for (std::size_t i = 0; i <= last; ++i) {
                const float spread = spreads[spreads.size() == 1 ? 0 : first + i];
                const vec2 uv(u[i], v[i]);
                if (spread < levels_.front().spread) {
                    radiances[first + i] = lookup.environment_radiance_at(uv, spread);
                    continue;
                }
                if (spread != known_spread) known = lookup.environment_levels_of(known_spread = spread);
                radiances[first + i] = lookup.blurred_environment_at(uv, known);
            }
        }
    }

  private:
    struct Level {
        const vec4* texels;
        int columns;
        int intervals;
        float spread;
    };

    // In one register, where compilers take a vec4 apart once its last component isn't asked for.
    using Float4 [[gnu::vector_size(16)]] = float;
    static Float4 load(const vec4& v) {
        Float4 result;
        std::memcpy(&result, &v, sizeof(result));
        return result;
    }

    // Its functions aren't const, for which GLSL has no word.
    struct Lookup {
        const EnvironmentMap& map;
        const std::vector<Level>& levels;

        // Bilinear, as GL_LINEAR with GL_REPEAT across and GL_CLAMP_TO_EDGE upward.
        vec3 sample_environment_map(vec2 uv) const {
            const int width = map.width();
            const int height = map.height();
            const float x = uv.x * static_cast<float>(width) - 0.5F;
            const float y = uv.y * static_cast<float>(height) - 0.5F;
            const int i = static_cast<int>(x + 1.0F) - 1;  // floor: both are at least -1/2
            const int j = static_cast<int>(y + 1.0F) - 1;
            const int left = i < 0 ? width - 1 : std::min(i, width - 1);
            const int right = left + 1 < width ? left + 1 : 0;
            const vec3* lower = &map.pixels()[std::size_t(std::max(j, 0)) * width];
            const vec3* upper = &map.pixels()[std::size_t(std::min(j + 1, height - 1)) * width];
            const float t = x - static_cast<float>(i);
            return mix(mix(lower[left], lower[right], t), mix(upper[left], upper[right], t),
                       y - static_cast<float>(j));
        }

        // Bilinear, with texels at the corners of the lattice.
        vec3 sample_environment_level(int level, vec2 uv) const {
            const Level& lattice = levels[level];
            const float x = uv.x * static_cast<float>(lattice.columns);
            const float y = uv.y * static_cast<float>(lattice.intervals);
            const int i = std::clamp(static_cast<int>(x), 0, lattice.columns - 1);
            const int j = std::clamp(static_cast<int>(y), 0, lattice.intervals - 1);
            const vec4* lower = lattice.texels + std::ptrdiff_t(j) * (lattice.columns + 1) + i;
            const vec4* upper = lower + lattice.columns + 1;
            const float s = x - static_cast<float>(i);
            const float t = y - static_cast<float>(j);
            const Float4 below = load(lower[0]) + s * (load(lower[1]) - load(lower[0]));
            const Float4 above = load(upper[0]) + s * (load(upper[1]) - load(upper[0]));
            const Float4 sample = below + t * (above - below);
            return {sample[0], sample[1], sample[2]};
        }

        float environment_spread(int level) const { return levels[level].spread; }
        int environment_last_level() const { return static_cast<int>(levels.size()) - 1; }

#include "shaders/lib/environment_lookup.glsl"
    };

    std::shared_ptr<const FilteredEnvironmentMap> environment_;
    std::vector<Level> levels_;
};

}  // namespace verglas::model
