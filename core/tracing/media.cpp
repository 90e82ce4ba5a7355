// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/media.h"

#include <algorithm>
#include <cmath>

#include "core/material/lobe_tables.h"

namespace verglas {
namespace {

// Indices that differ by less don't bend light; a lobe so narrow is beyond float.
constexpr float min_index_step = 1e-4F;

float relative_index(float before, float behind) {
    const float eta = std::clamp(behind / before, 1.0F / max_eta, max_eta);
    return std::abs(eta - 1.0F) < min_index_step ? 1.0F : eta;
}

std::uint16_t low_bits(int object) { return static_cast<std::uint16_t>(object); }

}  // namespace

// The newest that the surface bounds: of its object and material, or else, as a solid's walls may be of
// several materials, of its object; capacity where there is none.
int MediumStack::find(const Hit& hit) const {
    int of_object = capacity;
    for (int i = 0; i < capacity && materials_[i] != none; ++i) {
        if (objects_[i] != low_bits(hit.object)) continue;
        if (materials_[i] == hit.material) return i;
        of_object = std::min(of_object, i);
    }
    return of_object;
}

void MediumStack::enter(const Hit& hit) {
    std::copy_backward(materials_.begin(), materials_.end() - 1, materials_.end());
    std::copy_backward(objects_.begin(), objects_.end() - 1, objects_.end());
    materials_[0] = hit.material;
    objects_[0] = low_bits(hit.object);
}

void MediumStack::leave(const Hit& hit) {
    const int left = find(hit);
    if (left == capacity) return;
    std::copy(materials_.begin() + left + 1, materials_.end(), materials_.begin() + left);
    std::copy(objects_.begin() + left + 1, objects_.end(), objects_.begin() + left);
    materials_[capacity - 1] = none;
}

void MediumStack::cross(const Hit& hit, bool entering) {
    if (entering)
        enter(hit);
    else
        leave(hit);
}

// These media and, if it isn't among them, the one that the surface bounds, as the oldest.
MediumStack MediumStack::with(const Hit& hit) const {
    MediumStack media = *this;
    if (find(hit) < capacity) return media;
    const auto free = std::find(media.materials_.begin(), media.materials_.end() - 1, none);
    media.objects_[free - media.materials_.begin()] = low_bits(hit.object);
    *free = hit.material;
    return media;
}

// Material of the solid that counts among those with a priority; none outside of them.
int MediumStack::counted(const Scene& scene) const {
    int result = none;
    int highest = 0;
    for (int i = 0; i < capacity && materials_[i] != none; ++i) {
        const int priority = scene.materials[materials_[i]].priority;
        if (priority <= highest) continue;
        highest = priority;
        result = materials_[i];
    }
    return result;
}

// Whether an older entry is the same solid, as of a mesh that overlaps itself.
bool MediumStack::is_repeated(int i) const {
    for (int k = i + 1; k < capacity; ++k) {
        if (materials_[k] == materials_[i] && objects_[k] == objects_[i]) return true;
    }
    return false;
}

MediumStack::Interface MediumStack::interface(const Scene& scene, const Hit& hit, bool entering) const {
    const auto ior = [&scene](int material) {
        return material == none ? 1.0F : std::clamp(scene.materials[material].ior, 1.0F / max_eta, max_eta);
    };
    if (scene.materials[hit.material].priority == 0) {
        return {true,
                entering ? relative_index(1.0F, ior(hit.material)) : relative_index(ior(hit.material), 1.0F)};
    }
    const MediumStack before = entering ? *this : with(hit);
    MediumStack behind = *this;
    behind.cross(hit, entering);
    const int material_before = before.counted(scene);
    const int material_behind = behind.counted(scene);
    if (material_before == material_behind) return {};
    return {true, relative_index(ior(material_before), ior(material_behind))};
}

glm::vec3 MediumStack::transmittance(const Scene& scene, const Hit& hit, bool entering) const {
    const MediumStack media = entering ? *this : with(hit);
    const int nested = media.counted(scene);
    glm::vec3 sigma_a = nested == none ? glm::vec3(0.0F) : scene.materials[nested].absorption;
    for (int i = 0; i < capacity && media.materials_[i] != none; ++i) {
        const Material& material = scene.materials[media.materials_[i]];
        if (material.priority == 0 && !media.is_repeated(i)) sigma_a += material.absorption;
    }
    return glm::exp(-sigma_a * hit.t);
}

}  // namespace verglas
