// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/material/lobe_model.h"
#include "core/material/lobe_tables.h"
#include "core/scene/scene.h"
#include "core/scene/settings.h"

namespace verglas {

// Of one material at one relative index: which slices hold its lobes, or with analytic lobes their kinds
// (model::analytic_lobe_kind); -1 where it has none, as coatings have.
struct InterfaceTables {
    float eta = 1.0F;  // n_behind / n_before
    int refraction = -1;
    int reflection = -1;
};

// The slices of lobe tables that the materials of a scene need, each once.
class TableSet {
  public:
    // cache_folder: of LobeTables::load_or_build.
    explicit TableSet(std::filesystem::path cache_folder) : cache_folder_(std::move(cache_folder)) {}

    // Whether the slices have changed. Analytic lobes need none.
    bool update(const std::vector<Material>& materials, Lobes lobes);

    const std::vector<LobeSlice>& slices() const { return slices_; }
    model::LobeModel model() const;

    // The tables of a material at a relative index: one of those at which light can meet it, entering or
    // leaving.
    const InterfaceTables& tables(int material, float eta) const;

  private:
    using SliceKey = std::tuple<Ndf, float, LobeEvent>;  // distribution, relative index, event

    int number_of(Ndf ndf, float eta, LobeEvent event, std::vector<SliceKey>& keys) const;

    std::filesystem::path cache_folder_;
    Lobes lobes_ = Lobes::Table;
    std::map<Ndf, std::shared_ptr<const LobeTables>> tables_;
    std::vector<SliceKey> keys_;
    std::vector<LobeSlice> slices_;
    std::vector<std::vector<InterfaceTables>> of_materials_;
};

}  // namespace verglas
