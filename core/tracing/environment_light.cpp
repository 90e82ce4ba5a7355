// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/environment_light.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/material/model.h"

namespace verglas {
namespace {

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
    rows_.resize(height + 1);
    columns_.resize(std::size_t(height) * (width + 1));
    std::vector<double> row_weights(height);
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
        row_weights[y] = sine * cumulate(weights, &columns_[std::size_t(y) * (width + 1)]);
    }
    cumulate(row_weights, rows_.data());
}

const glm::vec3& EnvironmentLight::texel(int x, int y) const {
    const int column = (x % map_->width() + map_->width()) % map_->width();
    const int row = std::clamp(y, 0, map_->height() - 1);
    return map_->pixels()[std::size_t(row) * map_->width() + column];
}

glm::vec3 EnvironmentLight::radiance(const glm::vec3& direction) const {
    const glm::vec2 uv = model::environment_uv(glm::normalize(world_to_map_ * direction));
    const float x = uv.x * static_cast<float>(map_->width()) - 0.5F;
    const float y = uv.y * static_cast<float>(map_->height()) - 0.5F;
    const int i = static_cast<int>(std::floor(x));
    const int j = static_cast<int>(std::floor(y));
    const float s = x - static_cast<float>(i);
    const float t = y - static_cast<float>(j);
    return color_ * glm::mix(glm::mix(texel(i, j), texel(i + 1, j), s),
                             glm::mix(texel(i, j + 1), texel(i + 1, j + 1), s), t);
}

float EnvironmentLight::uv_pdf(glm::vec2 uv) const {
    const int width = map_->width();
    const int height = map_->height();
    const int x = std::clamp(static_cast<int>(uv.x * static_cast<float>(width)), 0, width - 1);
    const int y = std::clamp(static_cast<int>(uv.y * static_cast<float>(height)), 0, height - 1);
    const float* row = &columns_[std::size_t(y) * (width + 1)];
    return (rows_[y + 1] - rows_[y]) * (row[x + 1] - row[x]) * static_cast<float>(width) *
           static_cast<float>(height);
}

EnvironmentLight::Sample EnvironmentLight::sample(glm::vec2 u) const {
    const int width = map_->width();
    const int height = map_->height();
    const Place row = find(rows_.data(), height, u.y);
    const Place column = find(&columns_[std::size_t(row.cell) * (width + 1)], width, u.x);
    const glm::vec2 uv((static_cast<float>(column.cell) + column.within) / static_cast<float>(width),
                       (static_cast<float>(row.cell) + row.within) / static_cast<float>(height));
    const glm::vec3 direction = glm::transpose(world_to_map_) * model::environment_direction(uv);
    return {direction, pdf(direction)};
}

float EnvironmentLight::pdf(const glm::vec3& direction) const {
    const glm::vec2 uv = model::environment_uv(glm::normalize(world_to_map_ * direction));
    const float sine = std::sin(glm::pi<float>() * uv.y);
    if (sine < 1e-6F) return 0.0F;
    return uv_pdf(uv) / (2.0F * glm::pi<float>() * glm::pi<float>() * sine);
}

}  // namespace verglas
