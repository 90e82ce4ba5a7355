// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/geometry.h"

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>
#include <string>

namespace verglas {
namespace {

void scissor(const Rect& rect) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(rect.begin.x, rect.begin.y, rect.size().x, rect.size().y);
}

gl::Texture make_roughness(glm::ivec2 size, RoughnessData data) {
    if (data != RoughnessData::Values) return {};
    return {GL_RG16, size.x, size.y, GL_NEAREST};
}

gl::Framebuffer make_framebuffer(const gl::Texture& texels, const gl::Texture& roughness, RoughnessData data,
                                 const gl::Texture& class_pyramid, int number, const gl::Texture& depth) {
    const int first = number * class_layers(data);
    switch (data) {
        case RoughnessData::None:
            return gl::Framebuffer({{texels}}, &depth);
        case RoughnessData::Values:
            return gl::Framebuffer({{texels}, {roughness}}, &depth);
        case RoughnessData::Classes4:
            return gl::Framebuffer({{texels}, {class_pyramid, 0, first}}, &depth);
        case RoughnessData::Classes8:
            return gl::Framebuffer({{texels}, {class_pyramid, 0, first}, {class_pyramid, 0, first + 1}},
                                   &depth);
    }
    return {};
}

// Texture units.
enum Unit { roughness_unit, normals_unit, heights_unit, inner_roughness_unit };

// NEAREST_BACKS of shaders/geometry_buffer.glsl.
constexpr int nearest_backs = 4095;

// What a texel's index holds beside the material.
int group_of(Faces faces, int number) {
    if (faces == Faces::NearestFront) return number;
    return faces == Faces::NearestBack ? nearest_backs : 0;
}

bool is_front(Faces faces) { return faces == Faces::NearestFront || faces == Faces::FarthestFront; }
bool is_nearest(Faces faces) { return faces == Faces::NearestFront || faces == Faces::NearestBack; }

}  // namespace

gl::Texture make_class_pyramid(glm::ivec2 size, RoughnessData data, int buffers) {
    if (class_layers(data) == 0) return {};
    return {
        GL_RGBA8, size.x, size.y, GL_LINEAR, gl::mipmap_levels(size.x, size.y), buffers * class_layers(data)};
}

GeometryBuffer::GeometryBuffer(glm::ivec2 size, RoughnessData roughness_data,
                               const gl::Texture& class_pyramid, int number)
    : roughness_data_(roughness_data),
      texels_(GL_RGBA32F, size.x, size.y, GL_NEAREST),
      roughness_(make_roughness(size, roughness_data)),
      depth_(GL_DEPTH_COMPONENT32F, size.x, size.y, GL_NEAREST),
      framebuffer_(make_framebuffer(texels_, roughness_, roughness_data, class_pyramid, number, depth_)) {}

const gl::Program& GeometryPass::program(RoughnessData data, bool relief) {
    const std::pair key(data, relief);
    const auto found = programs_.find(key);
    if (found != programs_.end()) return found->second;
    std::vector<std::string> defines;
    if (data == RoughnessData::Values) defines.emplace_back("ROUGHNESS_VALUES");
    if (class_layers(data) > 0) defines.push_back("CLASS_LAYERS " + std::to_string(class_layers(data)));
    if (relief) defines.emplace_back("RELIEF");
    return programs_.emplace(key, gl::Program("geometry.vert.glsl", "geometry.frag.glsl", defines))
        .first->second;
}

void GeometryPass::clear(const GeometryBuffer& buffer, Faces faces, const Rect& rect) const {
    scissor(rect);
    const glm::vec4 nothing(0.0F, 0.0F, 0.0F, -1.0F);
    const float depth = is_nearest(faces) ? 1.0F : 0.0F;
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferfv(buffer.framebuffer().id(), GL_COLOR, 0, glm::value_ptr(nothing));
    glClearNamedFramebufferfv(buffer.framebuffer().id(), GL_DEPTH, 0, &depth);
    constexpr float not_covered[4] = {};
    for (int layer = 0; layer < class_layers(buffer.roughness_data()); ++layer)
        glClearNamedFramebufferfv(buffer.framebuffer().id(), GL_COLOR, 1 + layer, not_covered);
}

void GeometryPass::set_roughness(const gl::Program& program, const Material& material,
                                 const TextureCache& textures) {
    const auto& texture = material.roughness_texture;
    program.set("textured", texture ? 1 : 0);
    if (texture) glBindTextureUnit(roughness_unit, textures[texture].texture.id());
    program.set("roughness_value", mean_roughness(material, textures));
    const RoughnessClasses classes = roughness_classes(material, textures);
    glProgramUniform1fv(program.id(), glGetUniformLocation(program.id(), "class_roughness"),
                        static_cast<GLsizei>(classes.size()), classes.data());
}

void GeometryPass::set_inner_roughness(const gl::Program& program, const Material& material,
                                       const TextureCache& textures) {
    const auto& texture = material.layer.roughness_texture;
    program.set("inner_textured", texture ? 1 : 0);
    if (texture) glBindTextureUnit(inner_roughness_unit, textures[texture].texture.id());
    program.set("inner_roughness_value", std::clamp(material.layer.roughness, 0.0F, model::MAX_ROUGHNESS));
    program.set("is_pane", material.kind == MaterialKind::Pane ? 1 : 0);
}

// normal_axes depends on the object, too.
void GeometryPass::set_relief(const gl::Program& program, const Relief& relief, const Mesh& mesh,
                              const ReliefCache& reliefs) {
    const NormalMap& map = relief.normals;
    const bool has_normal_map = map.texture && mesh.relief().has(map);
    program.set("has_normal_map", has_normal_map ? 1 : 0);
    if (has_normal_map) glBindTextureUnit(normals_unit, reliefs[map.texture].id());
    program.set("tangent_space", map.space == NormalSpace::Tangent ? 1 : 0);
    program.set("normal_steepness", map.steepness);
    program.set("normal_strength", map.strength);
    const BumpMap& bump = relief.bump;
    const bool has_bump = bump.height && mesh.relief().has(bump);
    program.set("has_bump", has_bump ? 1 : 0);
    if (has_bump) glBindTextureUnit(heights_unit, reliefs[bump.height].id());
    program.set("bump_strength", bump.strength);
    program.set("bump_distance", bump.distance);
}

void GeometryPass::draw(const GeometryBuffer& buffer, Faces faces, const View& view, const ViewGroup& group,
                        int number, const Surfaces& surfaces) {
    glBindFramebuffer(GL_FRAMEBUFFER, buffer.framebuffer().id());
    glViewport(0, 0, view.size.x, view.size.y);
    scissor(group.rect);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(is_nearest(faces) ? GL_LESS : GL_GREATER);
    glEnable(GL_CULL_FACE);
    glCullFace(is_front(faces) ? GL_BACK : GL_FRONT);
    const bool with_relief = !surfaces.reliefs.empty();
    const gl::Program& program = this->program(buffer.roughness_data(), with_relief);
    program.use();
    program.set("roughness_texture", int{roughness_unit});
    program.set("inner_roughness_texture", int{inner_roughness_unit});
    program.set("normal_map", int{normals_unit});
    program.set("heights", int{heights_unit});
    program.set("projection", view.projection);
    program.set("group", group_of(faces, number));
    for (const ViewObject& item : group.objects) {
        // A mirrored object turns its triangles inside out.
        const glm::mat3 linear(item.model_to_view);
        const float handedness = glm::determinant(linear);
        glFrontFace(handedness < 0.0F ? GL_CW : GL_CCW);
        program.set("model_to_view", item.model_to_view);
        // Cofactors: the inverse transpose up to scale, for flattened objects too.
        const glm::mat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                  glm::cross(linear[0], linear[1]));
        const glm::mat3 normal_to_view = handedness < 0.0F ? -cofactors : cofactors;
        program.set("normal_to_view", normal_to_view);
        glBindVertexArray(item.mesh->array.id());
        const std::vector<int>& materials = item.object->materials;
        for (const MeshPart& part : item.object->mesh->parts()) {
            const int slot = std::min(part.slot, static_cast<int>(materials.size()) - 1);
            const Material& material = surfaces.materials[materials[slot]];
            const bool is_thin = material.kind != MaterialKind::Solid;
            if (is_thin && faces != Faces::NearestFront) continue;
            is_thin ? glDisable(GL_CULL_FACE) : glEnable(GL_CULL_FACE);
            program.set("two_sided", is_thin ? 1 : 0);
            program.set("material", materials[slot]);
            if (buffer.roughness_data() != RoughnessData::None)
                set_roughness(program, material, surfaces.textures);
            if (buffer.roughness_data() == RoughnessData::Values)
                set_inner_roughness(program, material, surfaces.textures);
            if (with_relief) {
                const Relief& relief = material.relief;
                set_relief(program, relief, *item.object->mesh, surfaces.reliefs);
                const bool is_world = relief.normals.space == NormalSpace::World;
                program.set("normal_axes", is_world ? glm::mat3(view.view) : normal_to_view);
            }
            // OpenGL takes the offset into the buffer as a pointer.
            const std::uintptr_t offset = std::uintptr_t{part.first} * sizeof(std::uint32_t);
            glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.count), GL_UNSIGNED_INT,
                           reinterpret_cast<const void*>(offset));  // NOLINT(performance-no-int-to-ptr)
        }
    }
    glDisable(GL_CULL_FACE);
    glDisable(GL_DEPTH_TEST);
}

}  // namespace verglas
