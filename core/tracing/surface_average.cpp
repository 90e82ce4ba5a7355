// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/surface_average.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace verglas {
namespace {

// Standard deviation of the weight's Gaussian over the difference of unit normals, in alpha; and its least
// value, since a pixel of a curved surface shows more than one normal. Measured on monkey, sphere and bottle.
constexpr float normal_deviations = 8.0F;
constexpr float least_deviation = 0.08F;

// Surfaces whose depths differ by more than this share lie one behind the other.
constexpr float depth_step = 0.05F;

float likeness(const Surface& a, const Surface& b) {
    if (a.object != b.object || std::abs(a.depth - b.depth) > depth_step * std::abs(a.depth)) return 0.0F;
    const float deviation = std::max(normal_deviations * std::min(a.alpha, b.alpha), least_deviation);
    const glm::vec3 difference = a.normal - b.normal;
    return std::exp(-0.5F * glm::dot(difference, difference) / (deviation * deviation));
}

}  // namespace

void average_surfaces(TracedPicture& picture) {
    const glm::ivec2 size = picture.rect.size();
    std::vector<glm::vec3> averaged(picture.radiance.size());
    tbb::parallel_for(0, size.y, [&](int y) {
        for (int x = 0; x < size.x; ++x) {
            const std::size_t place = std::size_t(y) * size.x + x;
            averaged[place] = picture.radiance[place];
            const Surface& surface = picture.surfaces[place];
            if (surface.object < 0) continue;
            glm::vec3 sum(0.0F);
            float weights = 0.0F;
            for (int j = std::max(y - 1, 0); j <= std::min(y + 1, size.y - 1); ++j) {
                for (int i = std::max(x - 1, 0); i <= std::min(x + 1, size.x - 1); ++i) {
                    const std::size_t other = std::size_t(j) * size.x + i;
                    const float weight = (i == x ? 2.0F : 1.0F) * (j == y ? 2.0F : 1.0F) *
                                         likeness(surface, picture.surfaces[other]);
                    sum += weight * picture.radiance[other];
                    weights += weight;
                }
            }
            averaged[place] = sum / weights;
        }
    });
    picture.radiance = std::move(averaged);
}

}  // namespace verglas
