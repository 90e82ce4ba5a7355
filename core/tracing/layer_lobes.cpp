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
    if (material.kind == MaterialKind::Coated) {
        result.add_coated(scene, hit, d, n);
        return result;
    }
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
    result.add_pane(scene, material, pane, d, n);
    if (outside.reflection >= 0)
        result.add(LayerLobe::Way::Mirrored,
                   scene.lobes().reflected_lobe(outside.reflection, pane.eta, pane.near_roughness, d, n),
                   material.reflection_color);
    return result;
}

void LayerLobes::add(LayerLobe::Way way, const model::Fan& fan, const glm::vec3& color) {
    for (const model::Lobe& lobe : fan.lobes) add(way, lobe, color);
}

void LayerLobes::add_pane(const TracedScene& scene, const Material& material, const model::Pane& pane,
                          const glm::vec3& d, const glm::vec3& n) {
    const model::PaneLobes lobes = scene.lobes().pane_lobes(pane, d, n);
    const glm::vec3 color = material.color * material.color;  // of two refractions
    add(LayerLobe::Way::Through, model::lobe_from_moments(lobes.transmitted), color);
    add(LayerLobe::Way::Through, lobes.trapped, color);
    add(LayerLobe::Way::FromWithin, lobes.reflected, color);
}

void LayerLobes::add_coated(const TracedScene& scene, const Hit& hit, const glm::vec3& d,
                            const glm::vec3& n) {
    const Material& material = scene.scene().materials[hit.material];
    const Layer& layer = material.layer;
    const model::CoatingModel& lobes = scene.coating_lobes();
    const model::Coating coating{.table = scene.coating_table(hit.material),
                                 .outer_roughness = roughness_at(material, hit),
                                 .base_roughness = inner_roughness_at(material, hit),
                                 .optical_depth = material.optical_depth(),
                                 .base_color = layer.base_color,
                                 .edge_tint = layer.edge_tint,
                                 .diffuse = layer.diffuse,
                                 .bounces = std::min(layer.bounces, Layer::max_bounces)};
    const model::CoatingPlace place = lobes.coating_place(coating, d, n);
    const model::CoatingColors colors =
        model::coating_colors(coating, lobes.coating_light(coating.table, place));
    for (int group = 0; group < model::COATING_GROUPS; ++group) {
        if (model::greatest(colors.groups[group]) <= 0.0F) continue;
        const bool mirrored = group == model::COATING_MIRRORED;
        const glm::vec3 color =
            colors.groups[group] * (mirrored ? material.reflection_color : material.color * material.color);
        const float further = group == model::COATING_FIRST ? colors.further : 0.0F;
        const LayerLobe::Way way = mirrored ? LayerLobe::Way::Mirrored : LayerLobe::Way::FromWithin;
        const int parts = model::coating_parts(coating.table, group);
        for (int i = 0; i < parts; ++i) {
            const model::Lobe part = lobes.coating_part(coating.table, place, group, i, further);
            add(way, lobes.coating_lobe(place, part, 1.0F), color);
            if (parts > 1) add(way, lobes.coating_lobe(place, part, -1.0F), color);
        }
    }
}

}  // namespace verglas
