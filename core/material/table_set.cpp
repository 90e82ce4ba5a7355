// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/table_set.h"

#include <algorithm>
#include <cmath>

namespace verglas {
namespace {

// The relative indices at which light can meet a material, on entering and on leaving: against the outside,
// and among materials with a priority against each other.
std::vector<float> relative_indices(const Material& material, const std::vector<Material>& materials) {
    std::vector<float> indices;
    const auto add = [&indices](float eta) {
        const float clamped = std::clamp(eta, 1.0F / max_eta, max_eta);
        if (std::find(indices.begin(), indices.end(), clamped) == indices.end()) indices.push_back(clamped);
    };
    add(material.ior);
    add(1.0F / material.ior);
    if (material.priority == 0) return indices;
    for (const Material& other : materials) {
        if (other.priority == 0 || other.ior == material.ior) continue;
        add(material.ior / other.ior);
        add(other.ior / material.ior);
    }
    return indices;
}

}  // namespace

bool TableSet::update(const std::vector<Material>& materials, Lobes lobes) {
    const bool other_lobes = lobes != lobes_;
    lobes_ = lobes;
    std::vector<SliceKey> keys;
    of_materials_.clear();
    for (const Material& material : materials) {
        const LobeEvent refraction = material.fresnel ? LobeEvent::Refract : LobeEvent::RefractWithout;
        std::vector<InterfaceTables>& tables = of_materials_.emplace_back();
        for (const float eta : relative_indices(material, materials)) {
            InterfaceTables& added = tables.emplace_back();
            added.eta = eta;
            if (material.kind == MaterialKind::Coated) continue;  // whose tables are a CoatingSet's
            added.refraction = number_of(material.ndf, eta, refraction, keys);
            if (material.fresnel) added.reflection = number_of(material.ndf, eta, LobeEvent::Reflect, keys);
        }
    }
    if (keys == keys_ && !other_lobes) return false;
    keys_ = std::move(keys);
    slices_.clear();
    for (const auto& [ndf, eta, event] : keys_) {
        auto& tables = tables_[ndf];
        if (!tables) tables = LobeTables::load_or_build(ndf, cache_folder_);
        slices_.push_back(tables->slice(eta, event));
    }
    return true;
}

int TableSet::number_of(Ndf ndf, float eta, LobeEvent event, std::vector<SliceKey>& keys) const {
    if (lobes_ == Lobes::Analytic)
        return model::analytic_lobe_kind(static_cast<int>(ndf), static_cast<int>(event));
    const SliceKey key(ndf, eta, event);
    const auto found = std::find(keys.begin(), keys.end(), key);
    if (found != keys.end()) return static_cast<int>(found - keys.begin());
    keys.push_back(key);
    return static_cast<int>(keys.size()) - 1;
}

model::LobeModel TableSet::model() const {
    return lobes_ == Lobes::Analytic ? model::LobeModel::analytic() : model::LobeModel(slices_);
}

const InterfaceTables& TableSet::tables(int material, float eta) const {
    const std::vector<InterfaceTables>& all = of_materials_[material];
    return *std::min_element(all.begin(), all.end(), [eta](const auto& a, const auto& b) {
        return std::abs(a.eta - eta) < std::abs(b.eta - eta);
    });
}

}  // namespace verglas
