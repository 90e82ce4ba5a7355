// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/gpu_scene.h"

#include <algorithm>
#include <cstdint>
#include <glm/packing.hpp>
#include <string>
#include <unordered_set>
#include <utility>

#include "core/error.h"
#include "core/gl/debug.h"

namespace verglas {
namespace {

// One value a vertex, from a buffer of its own; none where there are no values.
template <typename Value>
gl::Buffer add_attribute(GLuint array, GLuint attribute, const std::vector<Value>& values) {
    if (values.empty()) return {};
    gl::Buffer buffer = gl::make_buffer(values.size() * sizeof(Value), values.data());
    glVertexArrayVertexBuffer(array, attribute, buffer.id(), 0, sizeof(Value));
    glEnableVertexArrayAttrib(array, attribute);
    glVertexArrayAttribFormat(array, attribute, Value::length(), GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array, attribute, attribute);
    return buffer;
}

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
    result.uvs = add_attribute(array, 2, mesh.uvs());
    result.normal_uvs = add_attribute(array, 3, mesh.relief().normal_uvs);
    result.tangents = add_attribute(array, 4, mesh.relief().tangents);
    result.height_uvs = add_attribute(array, 5, mesh.relief().height_uvs);
    return result;
}

GLint wrap_of(Extension extension) {
    switch (extension) {
        case Extension::Repeat:
            return GL_REPEAT;
        case Extension::Extend:
            return GL_CLAMP_TO_EDGE;
        case Extension::Clip:
            return GL_CLAMP_TO_BORDER;  // the border's colour is 0
    }
    return GL_REPEAT;
}

// How values are stored and given to OpenGL. Half a float is enough for a normal.
struct Format {
    GLenum stored;
    GLenum given;
};
Format format_of(const Texture&) { return {GL_R32F, GL_RED}; }
Format format_of(const VectorTexture&) { return {GL_RGB16F, GL_RGB}; }

// levels: of mipmaps; 0 for all.
template <typename Value>
gl::Texture upload(const TextureOf<Value>& texture, int levels) {
    GLint greatest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &greatest);
    const int longer = std::max(texture.width(), texture.height());
    if (longer > greatest)
        throw Error("Texture '" + texture.name() + "' is " + std::to_string(longer) +
                    " pixels long; the graphics driver takes up to " + std::to_string(greatest) + ".");
    if (levels == 0) levels = gl::mipmap_levels(texture.width(), texture.height());
    const Format format = format_of(texture);
    gl::Texture result(format.stored, texture.width(), texture.height(), GL_LINEAR, levels);
    glTextureParameteri(result.id(), GL_TEXTURE_WRAP_S, wrap_of(texture.extension()));
    glTextureParameteri(result.id(), GL_TEXTURE_WRAP_T, wrap_of(texture.extension()));
    if (texture.interpolation() == Interpolation::Closest) {
        glTextureParameteri(result.id(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        if (levels == 1) glTextureParameteri(result.id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    }
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(result.id(), 0, 0, 0, texture.width(), texture.height(), format.given, GL_FLOAT,
                        texture.values().data());
    if (levels > 1) glGenerateTextureMipmap(result.id());
    return result;
}

// As `struct Material` of shaders/materials.glsl, std430.
struct MaterialData {
    glm::vec4 color_roughness;
    glm::vec4 reflection_ior;
    glm::vec4 absorption;
    std::array<std::uint32_t, model::MAX_ROUGHNESS_CLASSES / 2> class_roughness;
    glm::ivec4 tables;
};

// As `struct Layer` there.
struct LayerData {
    glm::vec4 base_color;
    glm::vec4 edge_tint;
    glm::vec4 optical_depth;
    glm::ivec4 kind;
    glm::ivec4 table;
    glm::vec4 table_ranges;
};

LayerData layer_data(const Material& material, const model::CoatingTable& table) {
    const Layer& layer = material.layer;
    return {{layer.base_color, layer.diffuse ? 1.0F : 0.0F},
            {layer.edge_tint, material.has_tails() ? 1.0F : 0.0F},
            {material.optical_depth(), 0.0F},
            {static_cast<int>(material.kind), std::min(layer.bounces, Layer::max_bounces),
             layer.inner_reflections ? 1 : 0, 0},
            {table.first_row, table.outer_nodes, table.base_nodes, table.divided},
            {table.outer_least, table.outer_greatest, table.base_least, table.base_greatest}};
}

// MaterialData::absorption.w.
float lobe_kind(const Material& material) {
    if (material.kind != MaterialKind::Solid) return -1.0F;
    return material.has_tails() ? 1.0F : 0.0F;
}

// Two in each.
std::array<std::uint32_t, model::MAX_ROUGHNESS_CLASSES / 2> packed(const RoughnessClasses& classes) {
    std::array<std::uint32_t, model::MAX_ROUGHNESS_CLASSES / 2> result{};
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = glm::packUnorm2x16({classes[2 * i], classes[2 * i + 1]});
    return result;
}

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

bool TextureCache::update(const std::vector<Material>& materials, int most_classes) {
    const gl::PassScope scope("upload of textures");
    bool changed = false;
    std::unordered_map<std::shared_ptr<const Texture>, GpuTexture> kept;
    const auto keep = [&](const std::shared_ptr<const Texture>& texture) {
        if (!texture || kept.count(texture) > 0) return;
        const auto known = textures_.find(texture);
        kept.emplace(
            texture,
            known != textures_.end()
                ? std::move(known->second)
                : GpuTexture{
                      upload(*texture, texture->is_atlas() ? 1 : 0), RoughnessHistogram(*texture), 0, {}});
        changed = changed || known == textures_.end();
    };
    for (const Material& material : materials) {
        keep(material.roughness_texture);
        if (material.kind != MaterialKind::Solid) keep(material.layer.roughness_texture);
    }
    textures_ = std::move(kept);
    for (auto& [texture, uploaded] : textures_) {
        if (uploaded.most_classes == most_classes) continue;
        uploaded.most_classes = most_classes;
        uploaded.classes = uploaded.histogram.classes(most_classes);
    }
    scope.check();
    return changed;
}

int TextureCache::most_classes() const {
    std::size_t most = 0;
    for (const auto& [texture, uploaded] : textures_) most = std::max(most, uploaded.classes.size());
    return static_cast<int>(most);
}

bool ReliefCache::update(const std::vector<Material>& materials) {
    const gl::PassScope scope("upload of relief");
    bool changed = false;
    Textures kept;
    const auto keep = [&](const auto& texture) {
        if (!texture || kept.count(texture) > 0) return;
        const auto known = textures_.find(texture);
        kept.emplace(texture, known != textures_.end() ? std::move(known->second) : upload(*texture, 1));
        changed = changed || known == textures_.end();
    };
    for (const Material& material : materials) {
        keep(material.relief.normals.texture);
        keep(material.relief.bump.height);
    }
    textures_ = std::move(kept);
    scope.check();
    return changed;
}

float mean_roughness(const Material& material, const TextureCache& textures) {
    if (material.roughness_texture) return textures[material.roughness_texture].histogram.mean();
    const float most = material.kind == MaterialKind::Coated ? model::MAX_ROUGHNESS : 1.0F;
    return std::clamp(material.roughness, 0.0F, most);
}

RoughnessClasses roughness_classes(const Material& material, const TextureCache& textures) {
    RoughnessClasses result{};
    result.fill(mean_roughness(material, textures));
    if (!material.roughness_texture) return result;
    const std::vector<float>& classes = textures[material.roughness_texture].classes;
    result.fill(classes.back());
    std::copy(classes.begin(), classes.end(), result.begin());
    return result;
}

bool MaterialCache::update(const std::vector<Material>& materials, const TextureCache& textures,
                           Lobes lobes) {
    const gl::PassScope scope("upload of materials");
    const bool changed = tables_.update(materials, lobes);
    const bool coatings_changed = coatings_.update(materials);
    std::vector<MaterialData> data;
    std::vector<LayerData> layers;
    for (int i = 0; i < static_cast<int>(materials.size()); ++i) {
        const Material& material = materials[i];
        const InterfaceTables& entering = tables_.tables(i, material.ior);
        data.push_back({{material.color, mean_roughness(material, textures)},
                        {material.reflection_color, entering.eta},
                        {material.absorption, lobe_kind(material)},
                        packed(roughness_classes(material, textures)),
                        {entering.refraction, tables_.tables(i, 1.0F / material.ior).refraction,
                         entering.reflection, tables_.tables(i, 1.0F / material.ior).reflection}});
        layers.push_back(layer_data(material, coatings_.table(i)));
    }
    if (data.empty()) return false;
    buffer_ = gl::make_buffer(data.size() * sizeof(MaterialData), data.data());
    has_thin_layers_ = std::any_of(materials.begin(), materials.end(), [](const Material& material) {
        return material.kind != MaterialKind::Solid;
    });
    if (has_thin_layers_) layers_ = gl::make_buffer(layers.size() * sizeof(LayerData), layers.data());
    if (changed) upload_tables();
    if (coatings_changed) upload_coatings();
    scope.check();
    return changed || coatings_changed;
}

void MaterialCache::upload_coatings() {
    constexpr int width = model::COATING_ITEMS * model::COATING_ANGLES;
    const std::vector<glm::vec4>& rows = coatings_.rows();
    if (rows.empty()) return;
    const int height = static_cast<int>(rows.size()) / width;
    coating_rows_ = gl::Texture(GL_RGBA32F, width, height, GL_NEAREST, 1);
    glTextureSubImage2D(coating_rows_.id(), 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, rows.data());
}

void MaterialCache::upload_tables() {
    const std::vector<LobeSlice>& slices = tables_.slices();
    if (slices.empty()) return;
    lobe_tables_ = gl::Texture(GL_RGBA32F, model::LOBE_COSINES, model::LOBE_ROUGHNESSES, GL_LINEAR, 1,
                               static_cast<int>(slices.size()));
    for (int layer = 0; layer < static_cast<int>(slices.size()); ++layer) {
        glTextureSubImage3D(lobe_tables_.id(), 0, 0, 0, layer, model::LOBE_COSINES, model::LOBE_ROUGHNESSES,
                            1, GL_RGBA, GL_FLOAT, slices[layer].data());
    }
}

void LightBuffer::update(const std::vector<Light>& lights, const glm::mat4& view) {
    struct LightData {
        glm::vec4 place;
        glm::vec4 axis;
        glm::vec4 intensity;
    };
    std::vector<LightData> data;
    for (const Light& light : lights) {
        const float w = light.kind == LightKind::Sun ? 0.0F : 1.0F;
        data.push_back({glm::vec4(glm::vec3(view * glm::vec4(light.place, w)), light.radius),
                        glm::vec4(glm::mat3(view) * light.axis, static_cast<float>(light.kind)),
                        glm::vec4(light.intensity, 0.0F)});
    }
    count_ = static_cast<int>(data.size());
    if (count_ > 0) buffer_ = gl::make_buffer(data.size() * sizeof(LightData), data.data());
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
