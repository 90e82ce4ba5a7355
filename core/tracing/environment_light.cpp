// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/environment_light.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numeric>

#include "core/material/model.h"

namespace verglas {
namespace {

// Concentration of a lobe as wide as half a cell of the grid.
constexpr float cell_kappa = 100.0F;

// Turns weights into cumulated shares with a 0 before them; uniform where all weights are 0. Returns their
// sum.
double cumulate(const std::vector<double>& weights, float* shares) {
    double sum = 0.0;
    for (const double weight : weights) sum += weight;
    double running = 0.0;
    shares[0] = 0.0F;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        running += sum > 0.0 ? weights[i] / sum : 1.0 / static_cast<double>(weights.size());
        shares[i + 1] = static_cast<float>(running);
    }
    shares[weights.size()] = 1.0F;
    return sum;
}

struct Place {
    int cell;
    float within;  // 0 … 1
};

Place find(const float* shares, int count, float u) {
    const float* above = std::upper_bound(shares, shares + count + 1, u);
    const int cell = std::clamp(static_cast<int>(above - shares) - 1, 0, count - 1);
    const float width = shares[cell + 1] - shares[cell];
    return {cell, width > 0.0F ? std::min((u - shares[cell]) / width, 1.0F) : 0.5F};
}

// The place of u times the sum in weights that lie `stride` apart.
Place find_weight(const float* weights, int count, std::ptrdiff_t stride, float sum, float u) {
    float left = u * sum;
    int i = 0;
    while (i < count - 1 && left >= weights[i * stride]) left -= weights[i++ * stride];
    const float weight = weights[i * stride];
    return {i, weight > 0.0F ? std::min(left / weight, 1.0F) : 0.5F};
}

// The last of `count` parts of `size` elements, part i begun at i size / count, that holds element x.
int part_of(int x, int size, int count) { return ((x + 1) * count - 1) / size; }

}  // namespace

EnvironmentLight::EnvironmentLight(const Scene& scene)
    : map_(scene.environment_map),
      color_(scene.environment_color),
      world_to_map_(scene.environment_rotation) {
    if (!map_)
        map_ = std::make_shared<const EnvironmentMap>("uniform", 2, 1,
                                                      std::vector<glm::vec3>(2, glm::vec3(1.0F)));
    const int width = map_->width();
    const int height = map_->height();
    columns_.resize(std::size_t(height) * (width + 1));
    std::vector<double> row_light(height);
    std::vector<double> weights(width);
    for (int y = 0; y < height; ++y) {
        // The light of a texel reaches, by interpolation, half-way into its neighbours: their means are safe
        // shares.
        for (int x = 0; x < width; ++x) {
            weights[x] = 0.0;
            for (int j = -1; j <= 1; ++j) {
                for (int i = -1; i <= 1; ++i) {
                    const glm::vec3& t = texel(x + i, y + j);
                    weights[x] += (t.r + t.g + t.b) * (i == 0 ? 2 : 1) * (j == 0 ? 2 : 1);
                }
            }
        }
        const double sine = std::sin(glm::pi<double>() * (y + 0.5) / height);
        row_light[y] = sine * cumulate(weights, &columns_[columns_of(y)]);
    }
    make_cells(row_light);
}

// row_light: of all texels of every row.
void EnvironmentLight::make_cells(const std::vector<double>& row_light) {
    const int width = map_->width();
    const int height = map_->height();
    rows_.resize(std::size_t(grid_columns) * (height + grid_rows));
    for (int i = 0; i < grid_columns; ++i) {
        for (int j = 0; j < grid_rows; ++j) {
            std::vector<double> weights;
            glm::dvec3 vector(0.0);
            for (int y = first_row(j); y < first_row(j + 1); ++y) {
                const float* columns = &columns_[columns_of(y)];
                weights.push_back(row_light[y] * (columns[first_column(i + 1)] - columns[first_column(i)]));
                for (int x = first_column(i); x < first_column(i + 1); ++x) {
                    const glm::vec2 uv((x + 0.5F) / width, (y + 0.5F) / height);
                    const double light = row_light[y] * (columns[x + 1] - columns[x]);
                    vector += light * glm::dvec3(model::environment_direction(uv));
                }
            }
            const int cell = i * grid_rows + j;
            light_[cell] = static_cast<float>(cumulate(weights, &rows_[rows_of(i, j)]));
            const glm::vec3 mean(vector / std::max(glm::length(vector), 1e-300));
            x_[cell] = mean.x;
            y_[cell] = mean.y;
            z_[cell] = mean.z;
        }
    }
}

const glm::vec3& EnvironmentLight::texel(int x, int y) const {
    const int column = (x % map_->width() + map_->width()) % map_->width();
    const int row = std::clamp(y, 0, map_->height() - 1);
    return map_->pixels()[std::size_t(row) * map_->width() + column];
}

glm::vec3 EnvironmentLight::radiance_at(glm::vec2 uv) const {
    const float x = uv.x * static_cast<float>(map_->width()) - 0.5F;
    const float y = uv.y * static_cast<float>(map_->height()) - 0.5F;
    const int i = static_cast<int>(std::floor(x));
    const int j = static_cast<int>(std::floor(y));
    const float s = x - static_cast<float>(i);
    const float t = y - static_cast<float>(j);
    return color_ * glm::mix(glm::mix(texel(i, j), texel(i + 1, j), s),
                             glm::mix(texel(i, j + 1), texel(i + 1, j + 1), s), t);
}

glm::vec3 EnvironmentLight::radiance(const glm::vec3& direction) const {
    return radiance_at(model::environment_uv(glm::normalize(world_to_map_ * direction)));
}

EnvironmentLight::Lobe EnvironmentLight::lobe(const glm::vec3& axis, float kappa) const {
    const glm::vec3 p = world_to_map_ * axis;
    // (1 + kappa (1 - cos) / 8)^-8 is a spherical Gaussian with longer tails: no light is left to chance.
    // Twice the concentration makes up for them; the lobes' concentrations are measured to give the least
    // noise so.
    const float sharpness = 2.0F * kappa * cell_kappa / (2.0F * kappa + cell_kappa) / 8.0F;
    Lobe lobe;
    lobe.rows.fill(0.0F);
    for (int i = 0; i < grid_columns; ++i) {
        for (int j = 0; j < grid_rows; ++j) {
            const int cell = i * grid_rows + j;
            float x = 1.0F + sharpness * (1.0F - (p.x * x_[cell] + p.y * y_[cell] + p.z * z_[cell]));
            x *= x;
            x *= x;
            x *= x;
            lobe.cells[cell] = light_[cell] / x;
            lobe.rows[j] += lobe.cells[cell];
        }
    }
    lobe.sum = std::accumulate(lobe.rows.begin(), lobe.rows.end(), 0.0F);
    return lobe;
}

// Of directions in texel (x, y), at the height v of the map.
float EnvironmentLight::pdf(const Lobe& lobe, int x, int y, float v) const {
    const int width = map_->width();
    const int height = map_->height();
    const int i = part_of(x, width, grid_columns);
    const int j = part_of(y, height, grid_rows);
    const float* rows = &rows_[rows_of(i, j) + y - first_row(j)];
    const float* columns = &columns_[columns_of(y)];
    const float columns_share = columns[first_column(i + 1)] - columns[first_column(i)];
    const float sine = std::sin(glm::pi<float>() * v);
    if (lobe.sum <= 0.0F || columns_share <= 0.0F || sine < 1e-6F) return 0.0F;
    const float share = lobe.cells[i * grid_rows + j] / lobe.sum * (rows[1] - rows[0]) *
                        (columns[x + 1] - columns[x]) / columns_share;
    return share * static_cast<float>(width) * static_cast<float>(height) /
           (2.0F * glm::pi<float>() * glm::pi<float>() * sine);
}

EnvironmentLight::Sample EnvironmentLight::sample(const Lobe& lobe, glm::vec2 u) const {
    const Place cell_row = find_weight(lobe.rows.data(), grid_rows, 1, lobe.sum, u.y);
    const int j = cell_row.cell;
    const Place cell_column = find_weight(&lobe.cells[j], grid_columns, grid_rows, lobe.rows[j], u.x);
    const int i = cell_column.cell;
    if (lobe.cells[i * grid_rows + j] <= 0.0F) return {glm::vec3(0.0F, 0.0F, 1.0F), glm::vec3(0.0F), 0.0F};
    const Place row = find(&rows_[rows_of(i, j)], first_row(j + 1) - first_row(j), cell_row.within);
    const int y = first_row(j) + row.cell;
    const float* columns = &columns_[columns_of(y) + first_column(i)];
    const int count = first_column(i + 1) - first_column(i);
    const Place column = find(columns, count, glm::mix(columns[0], columns[count], cell_column.within));
    const int x = first_column(i) + column.cell;
    const glm::vec2 uv((static_cast<float>(x) + column.within) / static_cast<float>(map_->width()),
                       (static_cast<float>(y) + row.within) / static_cast<float>(map_->height()));
    const glm::vec3 direction = glm::transpose(world_to_map_) * model::environment_direction(uv);
    return {direction, radiance_at(uv), pdf(lobe, x, y, uv.y)};
}

EnvironmentLight::Sample EnvironmentLight::at(const Lobe& lobe, const glm::vec3& direction) const {
    const glm::vec2 uv = model::environment_uv(glm::normalize(world_to_map_ * direction));
    const int x =
        std::clamp(static_cast<int>(uv.x * static_cast<float>(map_->width())), 0, map_->width() - 1);
    const int y =
        std::clamp(static_cast<int>(uv.y * static_cast<float>(map_->height())), 0, map_->height() - 1);
    return {direction, radiance_at(uv), pdf(lobe, x, y, uv.y)};
}

}  // namespace verglas
