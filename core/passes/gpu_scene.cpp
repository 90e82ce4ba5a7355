// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/gpu_scene.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "core/gl/debug.h"

namespace verglas {
namespace {

GpuMesh upload(const Mesh& mesh) {
    struct Vertex {
        glm::vec3 position;
        glm::vec3 normal;
    };
    std::vector<Vertex> vertices;
    vertices.reserve(mesh.positions().size());
    for (std::size_t v = 0; v < mesh.positions().size(); ++v)
        vertices.push_back({mesh.positions()[v], mesh.normals()[v]});

    GpuMesh result;
    result.vertices = gl::make_buffer(vertices.size() * sizeof(Vertex), vertices.data());
    result.indices = gl::make_buffer(mesh.indices().size() * sizeof(std::uint32_t), mesh.indices().data());
    result.array = gl::make_vertex_array();
    const GLuint array = result.array.id();
    glVertexArrayVertexBuffer(array, 0, result.vertices.id(), 0, sizeof(Vertex));
    glVertexArrayElementBuffer(array, result.indices.id());
    for (GLuint attribute = 0; attribute < 2; ++attribute) {
        glEnableVertexArrayAttrib(array, attribute);
        glVertexArrayAttribFormat(array, attribute, 3, GL_FLOAT, GL_FALSE, attribute * sizeof(glm::vec3));
        glVertexArrayAttribBinding(array, attribute, 0);
    }
    return result;
}

// As `struct Material` of shaders/refraction.frag.glsl, std430.
struct MaterialData {
    glm::vec4 color_roughness;
    glm::vec4 reflection_ior;
    glm::vec4 absorption;
    glm::ivec4 tables;
};

}  // namespace

bool MeshCache::update(const Scene& scene) {
    const gl::PassScope scope("upload of meshes");
    bool changed = false;
    std::unordered_map<std::shared_ptr<const Mesh>, GpuMesh> kept;
    for (const Object& object : scene.objects) {
        if (object.mesh->indices().empty() || kept.count(object.mesh) > 0) continue;
        const auto known = meshes_.find(object.mesh);
        kept.emplace(object.mesh, known != meshes_.end() ? std::move(known->second) : upload(*object.mesh));
        changed = changed || known == meshes_.end();
    }
    meshes_ = std::move(kept);
    scope.check();
    return changed;
}

bool MaterialCache::update(const std::vector<Material>& materials) {
    const gl::PassScope scope("upload of materials");
    const bool changed = tables_.update(materials);
    std::vector<MaterialData> data;
    for (int i = 0; i < static_cast<int>(materials.size()); ++i) {
        const Material& material = materials[i];
        const InterfaceTables& entering = tables_.tables(i, material.ior);
        data.push_back({{material.color, std::clamp(material.roughness, 0.0F, 1.0F)},
                        {material.reflection_color, entering.eta},
                        {material.absorption, 0.0F},
                        {entering.refraction, tables_.tables(i, 1.0F / material.ior).refraction,
                         entering.reflection, 0}});
    }
    if (data.empty()) return false;
    buffer_ = gl::make_buffer(data.size() * sizeof(MaterialData), data.data());
    if (changed) upload_tables();
    scope.check();
    return changed;
}

void MaterialCache::upload_tables() {
    const std::vector<LobeSlice>& slices = tables_.slices();
    lobe_tables_ = gl::Texture(GL_RGBA32F, model::LOBE_COSINES, model::LOBE_ROUGHNESSES, GL_LINEAR, 1,
                               static_cast<int>(slices.size()));
    for (int layer = 0; layer < static_cast<int>(slices.size()); ++layer) {
        glTextureSubImage3D(lobe_tables_.id(), 0, 0, 0, layer, model::LOBE_COSINES, model::LOBE_ROUGHNESSES,
                            1, GL_RGBA, GL_FLOAT, slices[layer].data());
    }
}

bool EnvironmentCache::update(const std::shared_ptr<const EnvironmentMap>& map) {
    // Without a map the light is the same from everywhere; its colour is the scene's factor.
    static const auto white =
        std::make_shared<const EnvironmentMap>("uniform", 1, 1, std::vector<glm::vec3>{glm::vec3(1.0F)});
    const auto& wanted = map ? map : white;
    if (environment_.map == wanted) return false;
    environment_ = filter_.filter(wanted);
    return true;
}

}  // namespace verglas
