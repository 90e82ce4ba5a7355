// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/environment/filtered_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>
#include <utility>

#include "core/material/model.h"

namespace verglas {
namespace model {
namespace {

// The weights of the blocks that add_band finds, one after the other from the block `first`.
class KernelWeights {
  public:
#include "shaders/lib/environment_filter.glsl"

    void clear() {
        first_ = 0;
        weights_.clear();
    }
    int first() const { return first_; }
    const std::vector<float>& values() const { return weights_; }

  private:
    void add_block(int block, float weight) {
        if (weights_.empty()) first_ = block;
        weights_.push_back(weight);
    }

    int first_ = 0;
    std::vector<float> weights_;
};

}  // namespace
}  // namespace model

namespace {

using glm::vec2;
using glm::vec4;

// A row of a source, whose blocks are summed around the sphere.
struct BlockRow {
    const vec4* texels;
    int block_size;  // texels from one block to the next
    int blocks;

    // The sum of weights from the block `first` on, -blocks … 2 blocks.
    vec4 weighted_sum(const std::vector<float>& weights, int first) const {
        const int begin = first < 0 ? first + blocks : first < blocks ? first : first - blocks;
        const int until_seam = std::min(static_cast<int>(weights.size()), blocks - begin);
        const float* seam = weights.data() + until_seam;
        return weighted_sum(weights.data(), seam, begin) +
               weighted_sum(seam, weights.data() + weights.size(), 0);
    }

  private:
    vec4 weighted_sum(const float* weight, const float* end, int block) const {
        vec4 sum(0.0F);
        const vec4* texel = texels + std::ptrdiff_t(block) * block_size;
        for (; weight != end; ++weight, texel += block_size) sum += *weight * *texel;
        return sum;
    }
};

// Adds what every target of a row, at the angle given by half_angle, gathers from a band. Targets and blocks
// lie to each other in a pattern that repeats, and so do the weights.
void add_band(std::vector<vec4>& sums, vec2 half_angle, const EnvironmentSource& source,
              const EnvironmentBand& band, const BlockRow& row, model::KernelWeights& weights) {
    const int columns = static_cast<int>(sums.size());
    const int repeats = std::gcd(columns, row.blocks);
    const int period = columns / repeats;
    const float reach = weights.kernel_reach(source.kappa);
    for (int phase = 0; phase < period; ++phase) {
        const float azimuth =
            2.0F * glm::pi<float>() * static_cast<float>(phase) / static_cast<float>(columns);
        weights.clear();
        if (!weights.add_band(half_angle, azimuth, reach, band.place, band.source.y, source.block_center))
            return;
        int first = weights.first();
        for (int column = phase; column < columns; column += period, first += row.blocks / repeats)
            sums[column] += row.weighted_sum(weights.values(), first);
    }
}

// texels: of the source, whose rows are `stride` texels apart.
EnvironmentLattice filter_level(const EnvironmentLevel& level, const EnvironmentSource& source,
                                const vec4* texels, int stride) {
    EnvironmentLattice lattice{level, {}};
    lattice.texels.resize(std::size_t(level.columns + 1) * (level.intervals + 1));
    tbb::parallel_for(
        tbb::blocked_range<int>(0, level.intervals + 1), [&](const tbb::blocked_range<int>& rows) {
            model::KernelWeights weights;
            std::vector<vec4> sums(level.columns);
            for (int row = rows.begin(); row < rows.end(); ++row) {
                const float angle =
                    glm::pi<float>() * static_cast<float>(row) / static_cast<float>(level.intervals);
                const vec2 half_angle(std::sin(0.5F * angle), std::cos(0.5F * angle));
                std::fill(sums.begin(), sums.end(), vec4(0.0F));
                for (const EnvironmentBand& band : source.bands) {
                    const int blocks = static_cast<int>(band.place.w);
                    const BlockRow source_row{texels + std::ptrdiff_t(band.source.x) * stride,
                                              source.columns / blocks, blocks};
                    add_band(sums, half_angle, source, band, source_row, weights);
                }
                vec4* target = &lattice.texels[std::size_t(row) * (level.columns + 1)];
                for (int column = 0; column < level.columns; ++column)
                    target[column] = sums[column] / sums[column].w;  // texels hold 1: their weights' sum
                target[level.columns] = target[0];
            }
        });
    return lattice;
}

}  // namespace

std::shared_ptr<const FilteredEnvironmentMap> filter_environment(std::shared_ptr<const EnvironmentMap> map) {
    const EnvironmentPicture picture = make_source_picture(*map);
    const std::vector<EnvironmentLevel> levels = plan_levels(picture.columns);
    std::vector<vec4> texels(picture.pixels.size());
    std::transform(picture.pixels.begin(), picture.pixels.end(), texels.begin(),
                   [](const glm::vec3& pixel) { return vec4(pixel, 1.0F); });
    auto result = std::make_shared<FilteredEnvironmentMap>();
    result->map = std::move(map);
    for (int l = 0; l < static_cast<int>(levels.size()); ++l) {
        const EnvironmentSource source = plan_source(levels, l);
        const bool from_map = source.level == map_source;
        const vec4* pixels = from_map ? texels.data() : result->levels[source.level].texels.data();
        result->levels.push_back(
            filter_level(levels[l], source, pixels, source.columns + (from_map ? 0 : 1)));
    }
    return result;
}

}  // namespace verglas
