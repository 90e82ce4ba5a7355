// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/material/lobe_tables.h"
#include "core/material/model.h"

namespace verglas::model {

// The part of shaders/lib that looks up the lobes of interfaces by number, for C++. Any number of threads may
// look up at the same time.
class LobeModel {
    // Their functions aren't const, for which GLSL has no word.
    struct TableLookup {
        const std::vector<LobeSlice>& tables;

        // Bilinear interpolation, as GL_LINEAR does with nodes at the centres of texels.
        vec4 sample_lobe_table(int table, float x, float y) const {
            const float column = clamp(x, 0.0F, 1.0F) * (LOBE_COSINES - 1);
            const float row = clamp(y, 0.0F, 1.0F) * (LOBE_ROUGHNESSES - 1);
            const int i = std::min(static_cast<int>(column), LOBE_COSINES - 2);
            const int j = std::min(static_cast<int>(row), LOBE_ROUGHNESSES - 2);
            const vec4* node = &tables[table][j * LOBE_COSINES + i];
            const float t = column - static_cast<float>(i);
            return mix(mix(node[0], node[1], t), mix(node[LOBE_COSINES], node[LOBE_COSINES + 1], t),
                       row - static_cast<float>(j));
        }

// clang-format off
#include "shaders/lib/table_lobe.glsl"
#include "shaders/lib/lobe_lookup.glsl"
#include "shaders/lib/pane_lookup.glsl"
        // clang-format on
    };

    struct AnalyticLookup {
        PlanarLobe planar_lobe(int kind, float cos_theta, float eta, float roughness) const {
            return analytic_lobe(kind, cos_theta, eta, roughness);
        }

// clang-format off
#include "shaders/lib/lobe_lookup.glsl"
#include "shaders/lib/pane_lookup.glsl"
        // clang-format on
    };

    template <typename Question>
    auto ask(Question question) const {
        return is_analytic_ ? question(AnalyticLookup{}) : question(TableLookup{tables_});
    }

  public:
    explicit LobeModel(std::vector<LobeSlice> tables) : tables_(std::move(tables)) {}
    // Without tables: numbers are those of analytic_lobe_kind.
    static LobeModel analytic() {
        LobeModel model({});
        model.is_analytic_ = true;
        return model;
    }

    Lobe reflected_lobe(int number, float eta, float roughness, const vec3& d, const vec3& n) const {
        return ask([&](auto lookup) { return lookup.reflected_lobe(number, eta, roughness, d, n); });
    }
    Lobe refracted_lobe(int number, float eta, float roughness, const vec3& d, const vec3& n, int tir) const {
        return ask([&](auto lookup) { return lookup.refracted_lobe(number, eta, roughness, d, n, tir); });
    }

    PaneLobes pane_lobes(const Pane& pane, const vec3& d, const vec3& n) const {
        return ask([&](auto lookup) { return lookup.pane_lobes(pane, d, n); });
    }

  private:
    std::vector<LobeSlice> tables_;
    bool is_analytic_ = false;
};

}  // namespace verglas::model
