// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/traced_scene.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "core/tracing/crossing.h"

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

void TracedScene::update(const Scene& scene, Lobes lobes) {
    scene_ = &scene;
    has_shadows_ = std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& material) {
        return material.kind == MaterialKind::Coated;
    });
    seconds_["meshes"] = seconds_of([&] { rays_.update(scene); });
    seconds_["tables"] = seconds_of([&] {
        if (tables_.update(scene.materials, lobes) || !lobes_) lobes_ = tables_.model();
        if (coatings_.update(scene.materials) || !coating_lobes_) coating_lobes_.emplace(coatings_.rows());
        update_roughness(scene);
    });
    seconds_["environment"] = seconds_of([&] { update_environment(scene.environment_map); });
}

glm::vec3 TracedScene::local_radiance(const glm::vec3& position, const glm::vec3& direction, float spread,
                                      const glm::vec3& side) const {
    glm::vec3 sum(0.0F);
    for (const Light& light : scene_->lights) {
        const model::LocalLight seen{static_cast<int>(light.kind), light.place, light.radius, light.axis,
                                     light.intensity};
        const glm::vec3 radiance = model::light_radiance(seen, position, direction, spread, side);
        if (model::greatest(radiance) > 0.0F && !is_shadowed(position, light)) sum += radiance;
    }
    return sum;
}

// By something coated; glass lets light through.
bool TracedScene::is_shadowed(const glm::vec3& position, const Light& light) const {
    if (!has_shadows_) return false;
    const glm::vec3 way = light.place - position;
    const bool is_sun = light.kind == LightKind::Sun;
    float distance = is_sun ? std::numeric_limits<float>::max() : glm::length(way) - light.radius;
    const glm::vec3 d = is_sun ? light.place : glm::normalize(way);
    constexpr int most_surfaces = 64;
    glm::vec3 origin = position;
    for (int i = 0; i < most_surfaces; ++i) {
        const auto hit = rays_.intersect(origin, d);
        if (!hit || hit->t >= distance) return false;
        if (scene_->materials[hit->material].kind == MaterialKind::Coated) return true;
        distance -= hit->t;
        origin = beside(*hit, d);
    }
    return true;
}

void TracedScene::update_roughness(const Scene& scene) {
    least_roughness_ = 1.0F;
    std::vector<char> material_varies;
    for (const Material& material : scene.materials) {
        const auto& texture = material.roughness_texture;
        const float least = texture ? texture->least() : material.roughness;
        if (material.kind == MaterialKind::Solid)
            least_roughness_ = std::min(least_roughness_, std::clamp(least, 0.0F, 1.0F));
        material_varies.push_back(texture && texture->least() < texture->greatest() ? 1 : 0);
    }
    varies_.clear();
    for (const Object& object : scene.objects)
        varies_.push_back(std::any_of(object.materials.begin(), object.materials.end(),
                                      [&](int material) { return material_varies[material] != 0; })
                              ? 1
                              : 0);
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
