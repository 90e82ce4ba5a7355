// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/traced_scene.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace verglas {
namespace {

template <typename Work>
double seconds_of(Work work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

TracedScene::TracedScene() : tables_(user_cache_folder()) {}

void TracedScene::update(const Scene& scene) {
    scene_ = &scene;
    seconds_["meshes"] = seconds_of([&] { rays_.update(scene); });
    seconds_["tables"] = seconds_of([&] {
        if (tables_.update(scene.materials) || !lobes_) lobes_.emplace(tables_.slices());
        update_roughness(scene.materials);
    });
    seconds_["environment"] = seconds_of([&] { update_environment(scene.environment_map); });
}

void TracedScene::update_roughness(const std::vector<Material>& materials) {
    std::map<std::shared_ptr<const Texture>, float> least_values;
    least_roughness_ = 1.0F;
    for (const Material& material : materials) {
        float least = material.roughness;
        if (const auto& texture = material.roughness_texture) {
            const auto known = least_values_.find(texture);
            least = known != least_values_.end()
                        ? known->second
                        : *std::min_element(texture->values().begin(), texture->values().end());
            least_values[texture] = least;
        }
        least_roughness_ = std::min(least_roughness_, std::clamp(least, 0.0F, 1.0F));
    }
    least_values_ = std::move(least_values);
}

void TracedScene::update_environment(const std::shared_ptr<const EnvironmentMap>& map) {
    // Without a map the light is the same from everywhere; its colour is the scene's factor.
    static const auto white =
        std::make_shared<const EnvironmentMap>("uniform", 1, 1, std::vector<glm::vec3>{glm::vec3(1.0F)});
    const auto& wanted = map ? map : white;
    if (map_ == wanted) return;
    environment_.emplace(filter_environment(wanted));
    map_ = wanted;
}

}  // namespace verglas
