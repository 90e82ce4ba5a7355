// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/scene/scene.h"

namespace verglas {

// The unfiltered environment for path tracing: radiance, and directions drawn in proportion to it and to a
// lobe of scattering.
class EnvironmentLight {
  public:
    explicit EnvironmentLight(const Scene& scene);

    // From a unit direction in world space; bilinear between texels, as Cycles and the OpenGL device.
    glm::vec3 radiance(const glm::vec3& direction) const;

    static constexpr int grid_columns = 32;
    static constexpr int grid_rows = 16;
    static constexpr std::size_t grid_cells = std::size_t(grid_columns) * grid_rows;

    // A distribution over the sphere. The cells of a coarse equirectangular grid are drawn in proportion to
    // their light times the lobe in their middle; inside a cell light alone decides.
    struct Lobe {
        std::array<float, grid_cells> cells;  // column by column
        std::array<float, grid_rows> rows;    // their sums
        float sum;
    };
    // axis: unit, in world space; kappa: concentration as of a spherical Gaussian, at least 0.
    Lobe lobe(const glm::vec3& axis, float kappa) const;

    struct Sample {
        glm::vec3 direction;
        glm::vec3 radiance;
        float pdf;  // per steradian, with which the direction is drawn; 0: the sample is void
    };
    // u in [0, 1)^2.
    Sample sample(const Lobe& lobe, glm::vec2 u) const;
    // What sample() would return with this unit direction.
    Sample at(const Lobe& lobe, const glm::vec3& direction) const;

  private:
    // Of the grid, as Lobe::cells.
    using Cells = std::array<float, grid_cells>;

    void make_cells(const std::vector<double>& row_light);
    const glm::vec3& texel(int x, int y) const;
    glm::vec3 radiance_at(glm::vec2 uv) const;
    float pdf(const Lobe& lobe, int x, int y, float v) const;
    int first_column(int i) const { return i * map_->width() / grid_columns; }
    int first_row(int j) const { return j * map_->height() / grid_rows; }
    // Where cell (i, j) begins in rows_, and row y in columns_.
    std::size_t rows_of(int i, int j) const {
        return std::size_t(i) * (map_->height() + grid_rows) + first_row(j) + j;
    }
    std::size_t columns_of(int y) const { return std::size_t(y) * (map_->width() + 1); }

    std::shared_ptr<const EnvironmentMap> map_;
    glm::vec3 color_;
    glm::mat3 world_to_map_;
    std::vector<float> columns_;  // of every row of texels: cumulated shares of its columns, from 0 to 1
    std::vector<float> rows_;     // of every cell, column by column: the same of the rows of texels in it
    Cells light_;                 // shares in all light
    Cells x_, y_, z_;             // mean directions, in the map's space
};

}  // namespace verglas
