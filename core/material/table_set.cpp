// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/table_set.h"

#include <algorithm>
#include <cmath>

namespace verglas {
namespace {

// The relative indices at which light can meet a material, on entering and on leaving.
std::vector<float> relative_indices(const Material& material, const std::vector<Material>& materials) {
    std::vector<float> indices;
    const auto add = [&indices](float eta) {
        const float clamped = std::clamp(eta, 1.0F / max_eta, max_eta);
        if (std::find(indices.begin(), indices.end(), clamped) == indices.end()) indices.push_back(clamped);
    };
    add(material.ior);
    add(1.0F / material.ior);
    return indices;
}

}  // namespace

bool TableSet::update(const std::vector<Material>& materials) {
    std::vector<SliceKey> keys;
    of_materials_.clear();
    for (const Material& material : materials) {
        const LobeEvent refraction = material.fresnel ? LobeEvent::Refract : LobeEvent::RefractWithout;
        std::vector<InterfaceTables>& tables = of_materials_.emplace_back();
        for (const float eta : relative_indices(material, materials)) {
            tables.push_back({eta, slice_of(material.ndf, eta, refraction, keys),
                              material.fresnel ? slice_of(material.ndf, eta, LobeEvent::Reflect, keys) : -1});
        }
    }
    if (keys == keys_) return false;
    keys_ = std::move(keys);
    slices_.clear();
    for (const auto& [ndf, eta, event] : keys_) {
        auto& tables = tables_[ndf];
        if (!tables) tables = LobeTables::load_or_build(ndf, cache_folder_);
        slices_.push_back(tables->slice(eta, event));
    }
    return true;
}

int TableSet::slice_of(Ndf ndf, float eta, LobeEvent event, std::vector<SliceKey>& keys) const {
    const SliceKey key(ndf, eta, event);
    const auto found = std::find(keys.begin(), keys.end(), key);
    if (found != keys.end()) return static_cast<int>(found - keys.begin());
    keys.push_back(key);
    return static_cast<int>(keys.size()) - 1;
}

const InterfaceTables& TableSet::tables(int material, float eta) const {
    const std::vector<InterfaceTables>& all = of_materials_[material];
    return *std::min_element(all.begin(), all.end(), [eta](const auto& a, const auto& b) {
        return std::abs(a.eta - eta) < std::abs(b.eta - eta);
    });
}

}  // namespace verglas
