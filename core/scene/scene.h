// SPDX-License-Identifier: GPL-3.0-or-later
// What is rendered, as plain data without OpenGL. Scenes are equal that share meshes, textures and maps and
// are alike in all else.
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

enum class MaterialKind : int {
    Solid = model::KIND_SOLID,    // glass that fills its object
    Pane = model::KIND_PANE,      // a thin sheet of glass, both of whose sides lie at the surface
    Coated = model::KIND_COATED,  // a clear layer on an opaque base
};

// The inner side of a thin layer: the far side of a pane, the base under a coating. Each of its members
// counts for the kinds that it names, or for both.
struct Layer {
    float roughness = 0.25F;                           // 0 … 1, alpha = roughness^2
    std::shared_ptr<const Texture> roughness_texture;  // in place of roughness, by Mesh::uvs; may be null
    bool inner_reflections = true;  // Pane: light that its sides reflect between them counts
    float thickness = 0.01F;        // Coated: in world units, along the normal
    // Coated: how often light that leaves has met the base, at most; 0 … max_bounces, 0: the outer side's
    // reflection alone
    int bounces = 2;
    bool diffuse = false;        // Coated: the base; else a rough conductor
    glm::vec3 base_color{0.8F};  // Coated: reflectance of the base at straight incidence, or its albedo
    glm::vec3 edge_tint{1.0F};   // Coated: of a conductor's reflectance at 82 degrees (F82), on Schlick's

    static constexpr int max_bounces = 8;

    bool operator==(const Layer&) const = default;
};

// A rough dielectric (Walter et al. 2007), alone or, in a thin layer, beside a second side.
struct Material {
    std::string name;
    MaterialKind kind = MaterialKind::Solid;
    Ndf ndf = Ndf::Beckmann;  // of solids and panes; coatings' normals have vMF distributions
    float roughness = 0.5F;   // 0 … 1, of coatings … MAX_ROUGHNESS; alpha is its square
    std::shared_ptr<const Texture> roughness_texture;  // in place of roughness; may be null
    Relief relief;                                     // of the normals
    float ior = 1.5F;                                  // inside relative to outside, 1 / max_eta … max_eta
    int priority = 0;                  // among overlapping solids, for the CPU's rays; see MediumStack
    glm::vec3 color{1.0F};             // factor of every refraction, linear
    glm::vec3 reflection_color{1.0F};  // factor of the front reflection, linear
    bool fresnel = true;               // false: all is refracted, as by Blender's Refraction BSDF
    glm::vec3 absorption{0.0F};        // sigma_a per world unit, of solids and coatings
    Layer layer;                       // of panes and coatings

    bool operator==(const Material&) const = default;
    // Whether lobes reach farther than Gaussians of their variance.
    bool has_tails() const { return ndf == Ndf::Ggx && kind != MaterialKind::Coated; }
    // Of a coating, straight through.
    glm::vec3 optical_depth() const { return absorption * layer.thickness; }
};

struct Object {
    std::string name;
    std::shared_ptr<const Mesh> mesh;
    glm::mat4 matrix{1.0F};      // object -> world
    std::vector<int> materials;  // by slot; slots past the end take the last

    bool operator==(const Object&) const = default;
};

enum class LightKind : int {
    Sphere = model::LIGHT_SPHERE,  // its light goes evenly to all sides
    Disk = model::LIGHT_DISK,      // as a sphere, but by the cosine to its axis: part of an area light
    Sun = model::LIGHT_SUN,        // from infinitely far away
};

// What shines beside the environment. Not seen itself.
struct Light {
    std::string name;
    LightKind kind = LightKind::Sphere;
    glm::vec3 place{0.0F};              // of the centre; of a sun the unit direction toward it; world space
    float radius = 0.0F;                // world units, 0 for a point; of a sun the half of its angle, radians
    glm::vec3 axis{0.0F, 0.0F, -1.0F};  // unit: where a disk shines to
    glm::vec3 intensity{1.0F};  // radiant, W/sr, of a disk along its axis; of a sun its irradiance, W/m^2

    bool operator==(const Light&) const = default;
};

struct Camera {
    glm::mat4 view{1.0F};        // world -> camera, which looks along -Z
    glm::mat4 projection{1.0F};  // OpenGL's, perspective or orthographic

    bool operator==(const Camera&) const = default;
};

struct Scene {
    std::vector<Material> materials;
    std::vector<Object> objects;
    std::vector<Light> lights;
    Camera camera;
    std::shared_ptr<const EnvironmentMap> environment_map;  // may be null
    glm::vec3 environment_color{0.0F};                      // radiance without a map, or the factor on it
    glm::mat3 environment_rotation{1.0F};                   // world direction -> map direction

    bool operator==(const Scene&) const = default;
};

}  // namespace verglas
