// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/layer_walk.h"

namespace verglas {
namespace {

// The same direction, or as the near side's frame from within has it.
glm::vec3 seen_from(bool is_near, const glm::vec3& d) { return is_near ? glm::vec3(d.x, d.y, -d.z) : d; }

}  // namespace

std::optional<LayerWalk> walk_layer(const LayeredSurface& layer, int bounces, const glm::vec3& o,
                                    const std::array<glm::vec3, LayerWalk::most_steps>& u) {
    const auto entered = layer.outside().sample(o, glm::vec2(u[0]), RoughInterface::Event::Refract);
    if (!entered) return std::nullopt;
    glm::vec3 d = entered->direction;
    glm::vec3 weight(entered->weight);
    for (int step = 1; step < LayerWalk::most_steps; ++step) {
        const bool is_near = d.z > 0.0F;
        if (!is_near && !layer.far()) {
            if (--bounces < 0) return std::nullopt;
            const auto met = layer.base().sample(-d, glm::vec2(u[step]));
            if (!met) return std::nullopt;
            weight *= met->weight * layer.transmittance(d.z) * layer.transmittance(met->direction.z);
            d = met->direction;
            continue;
        }
        const RoughInterface& side = is_near ? layer.near() : *layer.far();
        const auto met = side.sample(seen_from(is_near, -d), glm::vec2(u[step]), u[step].z);
        if (!met) return std::nullopt;
        weight *= met->weight;
        const glm::vec3 before = -d;
        d = seen_from(is_near, met->direction);
        if (met->direction.z < 0.0F) return LayerWalk{d, weight, before, is_near};
    }
    return std::nullopt;
}

}  // namespace verglas
