// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/material/lobe_tables.h"
#include "core/material/model.h"

namespace verglas::model {

// The part of shaders/lib that reads lobe tables, for C++. Any number of threads may look up at the same
// time.
class LobeModel {
    // Its functions aren't const, for which GLSL has no word.
    struct Lookup {
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

#include "shaders/lib/coated_lookup.glsl"
#include "shaders/lib/lobe_lookup.glsl"
#include "shaders/lib/pane_lookup.glsl"
    };

  public:
    explicit LobeModel(std::vector<LobeSlice> tables) : tables_(std::move(tables)) {}

    Lobe reflected_lobe(int table, float eta, float roughness, const vec3& d, const vec3& n) const {
        return Lookup{tables_}.reflected_lobe(table, eta, roughness, d, n);
    }
    Lobe refracted_lobe(int table, float eta, float roughness, const vec3& d, const vec3& n, int tir) const {
        return Lookup{tables_}.refracted_lobe(table, eta, roughness, d, n, tir);
    }

    BaseLight first_bounce(const Coating& coating, const vec3& d, const vec3& n) const {
        return Lookup{tables_}.first_bounce(coating, d, n);
    }
    BaseLight next_bounce(const Coating& coating, const BaseLight& light, const vec3& n) const {
        return Lookup{tables_}.next_bounce(coating, light, n);
    }
    Moments leaving_lobe(const Coating& coating, const BaseLight& light, const vec3& n) const {
        return Lookup{tables_}.leaving_lobe(coating, light, n);
    }
    Fan leaving_light(const Coating& coating, const BaseLight& light, const vec3& n) const {
        return Lookup{tables_}.leaving_light(coating, light, n);
    }
    PaneLobes pane_lobes(const Pane& pane, const vec3& d, const vec3& n) const {
        return Lookup{tables_}.pane_lobes(pane, d, n);
    }

  private:
    std::vector<LobeSlice> tables_;
};

}  // namespace verglas::model
