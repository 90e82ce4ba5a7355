// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/environment/level_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/material/model.h"

namespace verglas {
namespace {

constexpr int min_columns = 64;
constexpr int max_columns = 2048;
// Width of level 0's Gaussian in texels; below, bilinear interpolation shows between texels.
constexpr float sharpest_texels = 1.5F;
// The last level is nearly uniform.
constexpr float bluntest_kappa = 0.2F;
constexpr int least_level_columns = 16;
// The level that a level is filtered from. The wider the kernels are, the less exactly they are convolutions
// of each other, so the sharper the source; wide levels are small, and so still cheap.
int source_level(int level, float kappa) {
    const int step = kappa > 64.0F ? 1 : kappa > 8.0F ? 4 : 6;
    return std::max(level - step, 0);
}

EnvironmentBand make_band(double angle, double solid_angle, int blocks, int row, double kappa) {
    return {{std::sin(0.5 * angle), std::cos(0.5 * angle), solid_angle / blocks, blocks},
            {row, kappa, 0.0, 0.0}};
}

// Columns of a row that count as one: those of an arc of at most `rows` rows.
int block_size(double sine, double rows, int columns) {
    const double fitting = std::clamp(rows / std::max(sine, 1e-9), 1.0, static_cast<double>(columns));
    return 1 << (std::bit_width(static_cast<unsigned>(fitting)) - 1);
}

// Arcs of a quarter of a row keep the place and width of a small sun near a pole.
constexpr double map_block_rows = 0.25;
// Rows this close to a pole are split into bands, since the kernel changes across them in ways of its own.
constexpr int split_rows = 6;
constexpr int split_bands = 4;

// The map's texels are areas of constant radiance. Each band counts with its solid angle at its mean angle,
// int a sin(a) da / int sin(a) da; the mean variance of its blocks along and across, in an area of constant
// radiance, joins the kernel's 1 / kappa.
std::vector<EnvironmentBand> map_bands(int columns, double kappa) {
    std::vector<EnvironmentBand> bands;
    const int rows = columns / 2;
    const double step = glm::pi<double>() / rows;
    for (int row = 0; row < rows; ++row) {
        const double sine = std::sin(step * (row + 0.5));
        const int block = block_size(sine, map_block_rows, columns);
        const int parts = std::min(row, rows - 1 - row) < split_rows ? split_bands : 1;
        for (int part = 0; part < parts; ++part) {
            const double a = step * (row + double(part) / parts);
            const double b = step * (row + double(part + 1) / parts);
            const double solid_angle = std::cos(a) - std::cos(b);
            const double mean = (std::sin(b) - b * std::cos(b) - std::sin(a) + a * std::cos(a)) / solid_angle;
            const double across = (b - a) * (b - a) / 12.0;
            // A texel's own width; shared between two blocks, on average a sixth of the block's squared more.
            const double arc = sine * step;
            const double along = arc * arc / 12.0 + (block > 1 ? arc * arc * block * block / 6.0 : 0.0);
            // Blocks widen what they gather, which the kernel makes up for; texels are as wide as they are.
            const double variance = 0.5 * (across + arc * arc / 12.0) - 0.5 * (along - arc * arc / 12.0);
            bands.push_back(
                make_band(mean, solid_angle, columns / block, row, 1.0 / (1.0 / kappa + variance)));
        }
    }
    return bands;
}

// A lattice holds a smooth function: trapezoid rule, with the first Euler-Maclaurin term for the corner of
// f(a) sin(a) at the poles.
std::vector<EnvironmentBand> lattice_bands(const EnvironmentLevel& level, double kappa) {
    std::vector<EnvironmentBand> bands;
    const double step = glm::pi<double>() / level.intervals;
    for (int row = 0; row <= level.intervals; ++row) {
        const bool pole = row == 0 || row == level.intervals;
        const double sine = std::sin(step * row);
        const int blocks = pole ? 1 : level.columns / block_size(sine, 1.0, level.columns);
        bands.push_back(make_band(step * row, pole ? step * step / 12.0 : step * sine, blocks, row, kappa));
    }
    return bands;
}

float smallest_kappa(const std::vector<EnvironmentBand>& bands) {
    return std::min_element(
               bands.begin(), bands.end(),
               [](const EnvironmentBand& a, const EnvironmentBand& b) { return a.source.y < b.source.y; })
        ->source.y;
}

// Shares every column out between the two blocks nearest to it, so that light keeps its place, and stores the
// blocks in their first columns.
void gather_blocks(std::vector<glm::vec3>& pixels, int columns) {
    const int rows = columns / 2;
    for (int row = 0; row < rows; ++row) {
        const int block =
            block_size(std::sin(glm::pi<double>() * (row + 0.5) / rows), map_block_rows, columns);
        if (block == 1) continue;
        const int blocks = columns / block;
        glm::vec3* texels = &pixels[std::size_t(row) * columns];
        std::vector<glm::dvec3> sums(blocks, glm::dvec3(0.0));
        for (int i = 0; i < columns; ++i) {
            const double position = (i + 0.5) / block - 0.5 + blocks;
            const int left = static_cast<int>(position);
            const double share = position - left;
            sums[left % blocks] += (1.0 - share) * glm::dvec3(texels[i]);
            sums[(left + 1) % blocks] += share * glm::dvec3(texels[i]);
        }
        for (int b = 0; b < blocks; ++b) texels[std::size_t(b) * block] = glm::vec3(sums[b] / double(block));
    }
}

}  // namespace

// For ENVIRONMENT_LEVEL_RATIO 2: columns follow the width of the Gaussian, 1, 3/4, 1/2, 3/8, ... of level
// 0's, so that blocks of a power of two columns, near the poles, divide them.
std::vector<EnvironmentLevel> plan_levels(int columns) {
    const float sigma = sharpest_texels * 2.0F * glm::pi<float>() / static_cast<float>(columns);
    std::vector<EnvironmentLevel> levels;
    int row = 0;
    for (float kappa = 1.0F / (sigma * sigma); levels.empty() || levels.back().kappa > bluntest_kappa;
         kappa /= model::ENVIRONMENT_LEVEL_RATIO) {
        const int half = static_cast<int>(levels.size()) / 2;
        const int exact = levels.size() % 2 == 0 ? columns >> half : 3 * columns >> (half + 2);
        const int width = std::max(exact, least_level_columns);
        levels.push_back({kappa, width, width / 2, row});
        row += width / 2 + 1;
    }
    return levels;
}

EnvironmentSource plan_source(const std::vector<EnvironmentLevel>& levels, int level) {
    EnvironmentSource source;
    if (level == 0) {
        source = {map_source, levels[0].columns, 0.5F, map_bands(levels[0].columns, levels[0].kappa), 0.0F};
    } else {
        const int from = source_level(level, levels[level].kappa);
        const float sharper = model::spread_from_kappa(levels[from].kappa);
        const float spread = (model::spread_from_kappa(levels[level].kappa) - sharper) / (1.0F - sharper);
        source = {from, levels[from].columns, 0.0F,
                  lattice_bands(levels[from], model::kappa_from_spread(spread)), 0.0F};
    }
    source.kappa = smallest_kappa(source.bands);
    return source;
}

EnvironmentPicture make_source_picture(const EnvironmentMap& map) {
    const int columns = std::clamp(static_cast<int>(std::bit_ceil(static_cast<unsigned>(map.width()))),
                                   min_columns, max_columns);
    EnvironmentPicture picture{columns, map.resampled(columns)};
    gather_blocks(picture.pixels, columns);
    return picture;
}

}  // namespace verglas
