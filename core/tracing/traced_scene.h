// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/environment/environment_model.h"
#include "core/material/coating_model.h"
#include "core/material/coating_set.h"
#include "core/material/lobe_model.h"
#include "core/material/table_set.h"
#include "core/scene/scene.h"
#include "core/tracing/ray_scene.h"

namespace verglas {

// What traced bundles need of a scene: surfaces for rays, lobes of materials, the prefiltered environment.
// Can be asked by many threads, but not while update() runs.
class TracedScene {
  public:
    // Throws Error where Embree can't be started.
    TracedScene();

    // Follows the scene, which must outlive the questions, and builds only what has changed. Throws Error.
    void update(const Scene& scene, Lobes lobes);

    const Scene& scene() const { return *scene_; }
    const RayScene& rays() const { return rays_; }
    const model::LobeModel& lobes() const { return *lobes_; }
    const InterfaceTables& tables(int material, float eta) const { return tables_.tables(material, eta); }

    // Of coatings, whose tables they are, whatever gives the lobes of interfaces.
    const model::CoatingModel& coating_lobes() const { return *coating_lobes_; }
    const model::CoatingTable& coating_table(int material) const { return coatings_.table(material); }

    // The least roughness of any material, 0 … 1.
    float least_roughness() const { return least_roughness_; }
    // Whether a texture makes that of an object of the scene vary.
    bool roughness_varies(int object) const { return varies_[object] != 0; }

    // Light that arrives from outside under a lobe of the given spread about a unit direction in world space.
    glm::vec3 incoming_radiance(const glm::vec3& direction, float spread) const {
        return scene_->environment_color *
               environment_->environment_radiance(scene_->environment_rotation * direction, spread);
    }

    // The same about many directions, which become those of the map. spreads: as many, or one for all.
    // radiances: as many as directions.
    void incoming_radiance(std::span<glm::vec3> directions, std::span<const float> spreads,
                           std::span<glm::vec3> radiances) const {
        for (glm::vec3& direction : directions) direction = scene_->environment_rotation * direction;
        environment_->environment_radiance(directions, spreads, radiances);
        for (glm::vec3& radiance : radiances) radiance *= scene_->environment_color;
    }

    // Light that arrives from the scene's lights at a point beside a surface, under a lobe that leaves it;
    // what is coated is in its way. direction, side: unit; side: the surface's normal, to where the lobe
    // leaves.
    glm::vec3 local_radiance(const glm::vec3& position, const glm::vec3& direction, float spread,
                             const glm::vec3& side) const;

    // Wall time of the parts of the last update(), as Frame::prepare_seconds.
    const std::map<std::string, double>& seconds() const { return seconds_; }

  private:
    bool is_shadowed(const glm::vec3& position, const Light& light) const;
    void update_roughness(const Scene& scene);
    void update_environment(const std::shared_ptr<const EnvironmentMap>& map);

    const Scene* scene_ = nullptr;
    RayScene rays_;
    TableSet tables_;
    CoatingSet coatings_;
    std::optional<model::CoatingModel> coating_lobes_;
    std::optional<model::LobeModel> lobes_;
    float least_roughness_ = 0.0F;
    std::vector<char> varies_;  // by Scene::objects
    bool has_shadows_ = false;  // whether anything is coated
    std::shared_ptr<const EnvironmentMap> map_;
    std::optional<model::EnvironmentModel> environment_;
    std::map<std::string, double> seconds_;
};

}  // namespace verglas
