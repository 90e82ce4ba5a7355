// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/interface_lobe.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "core/error.h"
#include "core/material/lobe_model.h"

namespace verglas {
namespace {

std::shared_ptr<const LobeTables> tables_of(Ndf ndf) {
    static std::mutex mutex;
    static std::map<Ndf, std::shared_ptr<const LobeTables>> loaded;
    const std::lock_guard lock(mutex);
    auto& tables = loaded[ndf];
    if (!tables) tables = LobeTables::load_or_build(ndf, user_cache_folder());
    return tables;
}

}  // namespace

model::Lobe interface_lobe(Ndf ndf, float roughness, float eta, float cos_theta_o, LobeEvent event,
                           Lobes lobes) {
    if (!(roughness >= 0.0F && roughness <= 1.0F)) throw Error("A roughness must lie between 0 and 1.");
    if (!(eta > 0.0F)) throw Error("A relative index of refraction must be greater than 0.");
    if (!(cos_theta_o >= 0.0F && cos_theta_o <= 1.0F)) throw Error("A cosine must lie between 0 and 1.");
    eta = std::clamp(eta, 1.0F / max_eta, max_eta);
    const bool is_analytic = lobes == Lobes::Analytic;
    const model::LobeModel model =
        is_analytic ? model::LobeModel::analytic() : model::LobeModel({tables_of(ndf)->slice(eta, event)});
    const int number =
        is_analytic ? model::analytic_lobe_kind(static_cast<int>(ndf), static_cast<int>(event)) : 0;
    const glm::vec3 d(-std::sqrt(1.0F - cos_theta_o * cos_theta_o), 0.0F, -cos_theta_o);
    const glm::vec3 n(0.0F, 0.0F, 1.0F);
    return event == LobeEvent::Reflect ? model.reflected_lobe(number, eta, roughness, d, n)
                                       : model.refracted_lobe(number, eta, roughness, d, n, model::TIR_NONE);
}

}  // namespace verglas
