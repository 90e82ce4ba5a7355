// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/geometry.h"

#include <glm/gtc/type_ptr.hpp>

namespace verglas {
namespace {

void scissor(const Rect& rect) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(rect.begin.x, rect.begin.y, rect.size().x, rect.size().y);
}

bool is_front(Faces faces) { return faces == Faces::NearestFront || faces == Faces::FarthestFront; }
bool is_nearest(Faces faces) { return faces == Faces::NearestFront || faces == Faces::NearestBack; }

}  // namespace

GeometryBuffer::GeometryBuffer(glm::ivec2 size, bool with_roughness)
    : texels_(GL_RGBA32F, size.x, size.y, GL_NEAREST),
      roughness_(with_roughness ? gl::Texture(GL_R16, size.x, size.y, GL_NEAREST) : gl::Texture()),
      depth_(GL_DEPTH_COMPONENT32F, size.x, size.y, GL_NEAREST),
      framebuffer_(with_roughness ? gl::Framebuffer({{texels_}, {roughness_}}, &depth_)
                                  : gl::Framebuffer({{texels_}}, &depth_)) {}

GeometryPass::GeometryPass()
    : plain_("geometry.vert.glsl", "geometry.frag.glsl"),
      with_roughness_("geometry.vert.glsl", "geometry.frag.glsl", {"ROUGHNESS"}) {}

void GeometryPass::clear(const GeometryBuffer& buffer, Faces faces, const Rect& rect) const {
    scissor(rect);
    const glm::vec4 nothing(0.0F, 0.0F, 0.0F, -1.0F);
    const float depth = is_nearest(faces) ? 1.0F : 0.0F;
    glDepthMask(GL_TRUE);
    glClearNamedFramebufferfv(buffer.framebuffer().id(), GL_COLOR, 0, glm::value_ptr(nothing));
    glClearNamedFramebufferfv(buffer.framebuffer().id(), GL_DEPTH, 0, &depth);
}

void GeometryPass::draw(const GeometryBuffer& buffer, Faces faces, const View& view, const ViewGroup& group,
                        int number, const Surfaces& surfaces) const {
    glBindFramebuffer(GL_FRAMEBUFFER, buffer.framebuffer().id());
    glViewport(0, 0, view.size.x, view.size.y);
    scissor(group.rect);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(is_nearest(faces) ? GL_LESS : GL_GREATER);
    glEnable(GL_CULL_FACE);
    glCullFace(is_front(faces) ? GL_BACK : GL_FRONT);
    const gl::Program& program = buffer.has_roughness() ? with_roughness_ : plain_;
    program.use();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, surfaces.buffer.buffer().id());
    program.set("roughness_texture", 0);
    program.set("projection", view.projection);
    program.set("group", faces == Faces::NearestFront ? number : 0);
    for (const ViewObject& item : group.objects) {
        // A mirrored object turns its triangles inside out.
        const glm::mat3 linear(item.model_to_view);
        const float handedness = glm::determinant(linear);
        glFrontFace(handedness < 0.0F ? GL_CW : GL_CCW);
        program.set("model_to_view", item.model_to_view);
        // Cofactors: the inverse transpose up to scale, for flattened objects too.
        const glm::mat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                  glm::cross(linear[0], linear[1]));
        program.set("normal_to_view", handedness < 0.0F ? -cofactors : cofactors);
        glBindVertexArray(item.mesh->array.id());
        const std::vector<int>& materials = item.object->materials;
        for (const MeshPart& part : item.object->mesh->parts()) {
            const int slot = std::min(part.slot, static_cast<int>(materials.size()) - 1);
            program.set("material", materials[slot]);
            const auto& texture = surfaces.materials[materials[slot]].roughness_texture;
            program.set("textured", texture ? 1 : 0);
            if (texture) glBindTextureUnit(0, surfaces.textures[texture].texture.id());
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
