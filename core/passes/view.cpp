// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/passes/view.h"

#include <array>
#include <cmath>
#include <limits>

namespace verglas {
namespace {

std::array<glm::vec3, 8> corners_of(const Mesh& mesh, const glm::mat4& matrix) {
    std::array<glm::vec3, 8> corners;
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 corner((i & 1) != 0 ? mesh.upper().x : mesh.lower().x,
                               (i & 2) != 0 ? mesh.upper().y : mesh.lower().y,
                               (i & 4) != 0 ? mesh.upper().z : mesh.lower().z);
        corners[i] = glm::vec3(matrix * glm::vec4(corner, 1.0F));
    }
    return corners;
}

// Pixels around the corners, wide enough for the jitter of a wide filter; the whole frame where a corner lies
// behind the camera.
Rect project(const std::array<glm::vec3, 8>& corners, const glm::mat4& projection, glm::ivec2 size) {
    constexpr float margin = 12.0F;
    glm::vec2 low(std::numeric_limits<float>::max());
    glm::vec2 high(-std::numeric_limits<float>::max());
    for (const glm::vec3& corner : corners) {
        const glm::vec4 clip = projection * glm::vec4(corner, 1.0F);
        if (clip.w <= 1e-4F) return {glm::ivec2(0), size};
        const glm::vec2 pixel = (0.5F + 0.5F * glm::vec2(clip) / clip.w) * glm::vec2(size);
        low = glm::min(low, pixel);
        high = glm::max(high, pixel);
    }
    const glm::vec2 frame(size);
    return {glm::ivec2(glm::clamp(glm::floor(low - margin), glm::vec2(0.0F), frame)),
            glm::ivec2(glm::clamp(glm::ceil(high + margin), glm::vec2(0.0F), frame))};
}

}  // namespace

std::vector<ViewGroup> group_objects(const Scene& scene, const MeshCache& meshes, glm::ivec2 size,
                                     const Rect& region) {
    std::vector<ViewGroup> groups;
    // Which show what lies beside the region, blurred.
    const bool has_panes =
        std::any_of(scene.materials.begin(), scene.materials.end(),
                    [](const Material& material) { return material.kind == MaterialKind::Pane; });
    for (const Object& object : scene.objects) {
        if (object.mesh->indices().empty()) continue;
        ViewObject item;
        item.object = &object;
        item.mesh = &meshes[object.mesh];
        item.model_to_view = scene.camera.view * object.matrix;
        for (const int material : object.materials)
            item.kinds |= 1U << static_cast<unsigned>(scene.materials[material].kind);
        const auto corners = corners_of(*object.mesh, item.model_to_view);
        item.rect = project(corners, scene.camera.projection, size);
        item.diagonal = glm::distance(corners.front(), corners.back());
        for (int i = 1; i < 4; ++i)
            item.diagonal = std::max(item.diagonal, glm::distance(corners[i], corners[7 - i]));
        if (item.rect.intersected(has_panes ? Rect{{}, size} : region).empty()) continue;
        const auto fits = [&item](const ViewGroup& group) {
            return group.is_of_panes() == item.is_pane() &&
                   std::none_of(group.objects.begin(), group.objects.end(),
                                [&item](const ViewObject& other) { return other.rect.overlaps(item.rect); });
        };
        const auto group = std::find_if(groups.begin(), groups.end(), fits);
        if (group == groups.end()) {
            groups.push_back({{item}, item.rect});
        } else {
            group->objects.push_back(item);
            group->rect = group->rect.united(item.rect);
        }
    }
    std::stable_partition(groups.begin(), groups.end(),
                          [](const ViewGroup& group) { return !group.is_of_panes(); });
    return groups;
}

}  // namespace verglas
