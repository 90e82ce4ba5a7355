// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/layer_lobes.h"

#include <algorithm>
#include <utility>

#include "core/tracing/crossing.h"

namespace verglas {

LayerLobes LayerLobes::of(const TracedScene& scene, const Hit& hit, const glm::vec3& d, const glm::vec3& n,
                          bool entering) {
    LayerLobes result;
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
    if (material.kind == MaterialKind::Pane) {
        if (!entering) std::swap(pane.near_roughness, pane.far_roughness);
        result.add_pane(scene, material, pane, d, n);
    } else {
        result.add_coated(scene, material, pane, d, n);
    }
    if (outside.reflection >= 0)
        result.add({LayerLobe::Way::Mirrored,
                    scene.lobes().reflected_lobe(outside.reflection, pane.eta, pane.near_roughness, d, n),
                    material.reflection_color});
    return result;
}

void LayerLobes::add(const LayerLobe& lobe) {
    if (lobe.lobe.energy > 0.0F) lobes_[count_++] = lobe;
}

void LayerLobes::add(LayerLobe::Way way, const model::Fan& fan, const glm::vec3& color) {
    for (const model::Lobe& lobe : fan.lobes) add({way, lobe, color});
}

void LayerLobes::add_pane(const TracedScene& scene, const Material& material, const model::Pane& pane,
                          const glm::vec3& d, const glm::vec3& n) {
    const model::PaneLobes lobes = scene.lobes().pane_lobes(pane, d, n);
    const glm::vec3 color = material.color * material.color;  // of two refractions
    add({LayerLobe::Way::Through, model::lobe_from_moments(lobes.transmitted), color});
    add(LayerLobe::Way::Through, lobes.trapped, color);
    add(LayerLobe::Way::FromWithin, lobes.reflected, color);
}

void LayerLobes::add_coated(const TracedScene& scene, const Material& material, const model::Pane& outer,
                            const glm::vec3& d, const glm::vec3& n) {
    const Layer& layer = material.layer;
    if (layer.bounces < 1) return;
    const model::Coating coating{
        outer,           outer.far_roughness, material.optical_depth(), layer.base_color,
        layer.edge_tint, layer.diffuse};
    const glm::vec3 color = material.color * material.color;
    model::BaseLight light = scene.lobes().first_bounce(coating, d, n);
    for (int bounce = 1;; ++bounce) {
        if (light.lobe.spread < model::FANNED_SPREAD)
            add({LayerLobe::Way::FromWithin,
                 model::lobe_from_moments(scene.lobes().leaving_lobe(coating, light, n)),
                 color * light.color});
        else
            add(LayerLobe::Way::FromWithin, scene.lobes().leaving_light(coating, light, n),
                color * light.color);
        if (bounce >= std::min(layer.bounces, Layer::max_bounces) || outer.reflection_inside < 0) return;
        light = scene.lobes().next_bounce(coating, light, n);
    }
}

}  // namespace verglas
