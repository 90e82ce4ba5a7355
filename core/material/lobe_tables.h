// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of the lobes that a rough interface refracts and reflects (de Rousiers et al. 2012, section 4.1).
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/material/model.h"

namespace verglas {

enum class Ndf : int {
    Beckmann = model::NDF_BECKMANN,
    Ggx = model::NDF_GGX,
    BlinnPhong = model::NDF_BLINN_PHONG,
};

enum class LobeEvent : int {
    Refract = model::EVENT_REFRACT,
    RefractWithout = model::EVENT_REFRACT_WITHOUT,
    Reflect = model::EVENT_REFLECT,
};
constexpr int lobe_event_count = 3;

// Relative indices outside of [1 / max_eta, max_eta] are clamped.
constexpr float max_eta = 3.0F;

// One table at a fixed relative index: LOBE_COSINES x LOBE_ROUGHNESSES nodes, cosine fastest, each (energy,
// log2(spread / alpha^2), bend, away). Axes: model::lobe_table_x and lobe_table_y.
using LobeSlice = std::vector<glm::vec4>;

// All lobes of one distribution of normals, over cosine, roughness, relative index and event.
//
// With microfacet normals m drawn from D(m) (m.n), the weight of one sample is w = |o.m| G T / (|o.n| |m.n|),
// T = 1 - F, 1 or F, and W = mean(w), p R = sum(w i) / sum(w). Beyond the critical angle w = 0.
class LobeTables {
  public:
    // Computes the tables, in parallel.
    static std::shared_ptr<const LobeTables> build(Ndf ndf);

    // Reads the tables from the folder, or builds them and writes them there. A damaged or outdated file is
    // replaced; a folder that can't be written is no fault.
    static std::shared_ptr<const LobeTables> load_or_build(Ndf ndf, const std::filesystem::path& folder);

    // Interpolates the tables to one relative index.
    LobeSlice slice(float eta, LobeEvent event) const;

    // File of the cache: its name tells all that the tables depend on.
    static std::filesystem::path cache_file(Ndf ndf, const std::filesystem::path& folder);

  private:
    struct Node {
        float energy;
        float log_spread;  // log2(spread / alpha^2), for refraction of spread / (alpha^2 ln(eta)^2)
        float bend;
        float away;
    };

    LobeTables() = default;
    static std::shared_ptr<LobeTables> read(const std::filesystem::path& file);
    void write(const std::filesystem::path& file) const;

    std::vector<Node> nodes_;
};

// The user's cache folder of Verglas: $XDG_CACHE_HOME/verglas or ~/.cache/verglas.
std::filesystem::path user_cache_folder();

}  // namespace verglas
