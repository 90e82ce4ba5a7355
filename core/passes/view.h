// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <glm/glm.hpp>
#include <vector>

#include "core/passes/gpu_scene.h"
#include "core/scene/scene.h"
#include "core/scene/settings.h"

namespace verglas {

// One sample's look at the scene.
struct View {
    glm::mat4 view{1.0F};
    glm::mat4 projection{1.0F};  // with the sample's jitter
    glm::ivec2 size{0};
};

// An object in a view.
struct ViewObject {
    const Object* object = nullptr;
    const GpuMesh* mesh = nullptr;
    glm::mat4 model_to_view{1.0F};
    Rect rect;           // pixels that it can cover
    float diagonal = 0;  // of its bounding box in world units
    unsigned kinds = 0;  // bits of its materials' MaterialKind

    bool has(MaterialKind kind) const { return (kinds >> static_cast<unsigned>(kind) & 1U) != 0; }
    bool is_pane() const { return kinds == 1U << static_cast<unsigned>(MaterialKind::Pane); }
};

// Objects whose rectangles don't overlap share their passes, and no pixel of one sees the back of another.
// Panes, through which others are seen, are in groups of their own; objects that are panes in part are no
// panes here.
struct ViewGroup {
    std::vector<ViewObject> objects;
    Rect rect;  // around all

    bool has(MaterialKind kind) const {
        return std::any_of(objects.begin(), objects.end(),
                           [kind](const ViewObject& item) { return item.has(kind); });
    }
    bool is_of_panes() const { return objects.front().is_pane(); }
};

// The objects that can be seen in the region, in groups, those of panes last.
std::vector<ViewGroup> group_objects(const Scene& scene, const MeshCache& meshes, glm::ivec2 size,
                                     const Rect& region);

}  // namespace verglas
