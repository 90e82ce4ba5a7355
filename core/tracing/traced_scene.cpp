// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/traced_scene.h"

#include <chrono>

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
    });
    seconds_["environment"] = seconds_of([&] { update_environment(scene.environment_map); });
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
