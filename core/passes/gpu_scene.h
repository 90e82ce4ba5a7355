// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene needs on the GPU; uploads only what has changed, and says whether it has. Lives on the GL
// thread.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <unordered_map>
#include <vector>

#include "core/gl/objects.h"
#include "core/material/coating_set.h"
#include "core/material/model.h"
#include "core/material/roughness_classes.h"
#include "core/material/table_set.h"
#include "core/passes/environment_filter.h"
#include "core/scene/scene.h"

namespace verglas {

struct GpuMesh {
    gl::Buffer vertices;
    // None where the mesh has none; shaders then read zeros.
    gl::Buffer uvs;
    gl::Buffer normal_uvs;
    gl::Buffer tangents;
    gl::Buffer height_uvs;
    gl::Buffer indices;
    gl::VertexArray array;
};

// Meshes by identity; those that a scene no longer has are dropped.
class MeshCache {
  public:
    bool update(const Scene& scene);
    const GpuMesh& operator[](const std::shared_ptr<const Mesh>& mesh) const { return meshes_.at(mesh); }

  private:
    std::unordered_map<std::shared_ptr<const Mesh>, GpuMesh> meshes_;
};

// A texture of roughness, with mipmaps, in which a texel is the mean over its area. Atlases have none: there
// it would be the mean of places that have nothing to do with each other.
struct GpuTexture {
    gl::Texture texture;
    RoughnessHistogram histogram;
    int most_classes = 0;
    std::vector<float> classes;  // of RoughnessHistogram::classes(most_classes)
};

// Textures by identity; those that no material has any more are dropped.
class TextureCache {
  public:
    // most_classes: of roughness, for each texture. Returns whether there were new textures.
    bool update(const std::vector<Material>& materials, int most_classes);
    bool empty() const { return textures_.empty(); }
    // The most classes that a texture has.
    int most_classes() const;
    const GpuTexture& operator[](const std::shared_ptr<const Texture>& texture) const {
        return textures_.at(texture);
    }

  private:
    std::unordered_map<std::shared_ptr<const Texture>, GpuTexture> textures_;
};

// Textures of normals and heights by identity; those that no material has any more are dropped. Without
// mipmaps: the mean of bent normals would be a smooth surface's.
class ReliefCache {
  public:
    // Whether there were new textures.
    bool update(const std::vector<Material>& materials);
    bool empty() const { return textures_.empty(); }
    // texture: of a material's relief.
    const gl::Texture& operator[](const std::shared_ptr<const void>& texture) const {
        return textures_.at(texture);
    }

  private:
    using Textures = std::unordered_map<std::shared_ptr<const void>, gl::Texture>;
    Textures textures_;
};

// Of a material with a texture, its mean; 0 … 1.
float mean_roughness(const Material& material, const TextureCache& textures);

using RoughnessClasses = std::array<float, model::MAX_ROUGHNESS_CLASSES>;

// Filled up with the last one.
RoughnessClasses roughness_classes(const Material& material, const TextureCache& textures);

// Materials as a storage buffer, and an array of the lobe tables that they use.
class MaterialCache {
  public:
    // cache_folder: of LobeTables::load_or_build.
    explicit MaterialCache(std::filesystem::path cache_folder) : tables_(std::move(cache_folder)) {}
    // Whether the tables have changed.
    bool update(const std::vector<Material>& materials, const TextureCache& textures, Lobes lobes);
    const gl::Buffer& buffer() const { return buffer_; }
    bool has_thin_layers() const { return has_thin_layers_; }
    // Where it has some: of all materials, those parts.
    const gl::Buffer& layers() const { return layers_; }
    // None with analytic lobes.
    const gl::Texture& lobe_tables() const { return lobe_tables_; }
    // Where anything is coated: CoatingSet::rows().
    const gl::Texture& coating_rows() const { return coating_rows_; }

  private:
    void upload_tables();
    void upload_coatings();

    TableSet tables_;
    CoatingSet coatings_;
    gl::Buffer buffer_;
    bool has_thin_layers_ = false;
    gl::Buffer layers_;
    gl::Texture lobe_tables_;
    gl::Texture coating_rows_;
};

// The lights in camera space, as shaders/local_lights.glsl has them.
class LightBuffer {
  public:
    // view: world -> camera.
    void update(const std::vector<Light>& lights, const glm::mat4& view);
    // None without lights.
    const gl::Buffer& buffer() const { return buffer_; }
    int count() const { return count_; }

  private:
    gl::Buffer buffer_;
    int count_ = 0;
};

// The environment of the newest scene, prefiltered.
class EnvironmentCache {
  public:
    bool update(const std::shared_ptr<const EnvironmentMap>& map);
    const FilteredEnvironment& operator*() const { return environment_; }

  private:
    EnvironmentFilter filter_;
    FilteredEnvironment environment_;
};

}  // namespace verglas
