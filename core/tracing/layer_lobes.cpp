// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/layer_lobes.h"

#include <utility>

#include "core/tracing/crossing.h"

namespace verglas {

LayerLobes LayerLobes::of(const TracedScene& scene, const Hit& hit, const glm::vec3& d, const glm::vec3& n,
                          bool entering) {
    LayerLobes result;
    result.add_pane(scene, hit, d, n, entering);
    return result;
}

void LayerLobes::add(const LayerLobe& lobe) {
    if (lobe.lobe.energy > 0.0F) lobes_[count_++] = lobe;
}

void LayerLobes::add_pane(const TracedScene& scene, const Hit& hit, const glm::vec3& d, const glm::vec3& n,
                          bool entering) {
    const Material& material = scene.scene().materials[hit.material];
    const InterfaceTables& outside = scene.tables(hit.material, material.ior);
    const InterfaceTables& inside = scene.tables(hit.material, 1.0F / material.ior);
    model::Pane pane{outside.refraction,
                     inside.refraction,
                     outside.reflection,
                     inside.reflection,
                     outside.eta,
                     roughness_at(material, hit),
                     inner_roughness_at(material, hit),
                     material.layer.inner_reflections};
    if (!entering) std::swap(pane.near_roughness, pane.far_roughness);
    const model::PaneLobes lobes = scene.lobes().pane_lobes(pane, d, n);
    const glm::vec3 color = material.color * material.color;  // of two refractions
    add({false, model::lobe_from_moments(lobes.transmitted), color});
    for (const model::Lobe& trapped : lobes.trapped.lobes) add({false, trapped, color});
    if (outside.reflection < 0) return;
    add({true, scene.lobes().reflected_lobe(outside.reflection, pane.eta, pane.near_roughness, d, n),
         material.reflection_color});
    for (const model::Lobe& reflected : lobes.reflected.lobes) add({true, reflected, color});
}

}  // namespace verglas
