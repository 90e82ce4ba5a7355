// SPDX-License-Identifier: GPL-3.0-or-later
// What is rendered, as plain data without OpenGL. Scenes are equal that share meshes, textures and maps and are
// alike in all else.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/material/lobe_tables.h"
#include "core/scene/environment_map.h"
#include "core/scene/mesh.h"
#include "core/scene/relief.h"
#include "core/scene/texture.h"

namespace verglas {

// A rough dielectric (Walter et al. 2007).
struct Material {
    std::string name;
    Ndf ndf = Ndf::Beckmann;
    float roughness = 0.5F;                            // 0 … 1, alpha = roughness^2
    std::shared_ptr<const Texture> roughness_texture;  // in place of roughness; may be null
    Relief relief;                                     // of the normals
    float ior = 1.5F;                                  // inside relative to outside, 1 / max_eta … max_eta
    int priority = 0;                  // among overlapping solids, for the CPU's rays; see MediumStack
    glm::vec3 color{1.0F};             // factor of every refraction, linear
    glm::vec3 reflection_color{1.0F};  // factor of the front reflection, linear
    bool fresnel = true;               // false: all is refracted, as by Blender's Refraction BSDF
    glm::vec3 absorption{0.0F};        // sigma_a per world unit

    bool operator==(const Material&) const = default;
};

struct Object {
    std::string name;
    std::shared_ptr<const Mesh> mesh;
    glm::mat4 matrix{1.0F};      // object -> world
    std::vector<int> materials;  // by slot; slots past the end take the last

    bool operator==(const Object&) const = default;
};

struct Camera {
    glm::mat4 view{1.0F};        // world -> camera, which looks along -Z
    glm::mat4 projection{1.0F};  // OpenGL's, perspective or orthographic

    bool operator==(const Camera&) const = default;
};

struct Scene {
    std::vector<Material> materials;
    std::vector<Object> objects;
    Camera camera;
    std::shared_ptr<const EnvironmentMap> environment_map;  // may be null
    glm::vec3 environment_color{0.0F};                      // radiance without a map, or the factor on it
    glm::mat3 environment_rotation{1.0F};                   // world direction -> map direction

    bool operator==(const Scene&) const = default;
};

}  // namespace verglas
