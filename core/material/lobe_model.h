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
        const std::vector<vec4>& coating_rows;

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

        // Likewise, of CoatingSet::rows().
        vec4 sample_coating_rows(float column, float row) const {
            constexpr int width = COATING_ITEMS * COATING_ANGLES;
            const int i = std::min(static_cast<int>(column), width - 2);
            const int j = static_cast<int>(row);
            const float t = column - static_cast<float>(i);
            const float s = row - static_cast<float>(j);
            const vec4* node = &coating_rows[std::size_t(j) * width + i];
            const vec4 value = mix(node[0], node[1], t);
            return s > 0.0F ? mix(value, mix(node[width], node[width + 1], t), s) : value;
        }

#include "shaders/lib/coated_lookup.glsl"
#include "shaders/lib/lobe_lookup.glsl"
#include "shaders/lib/pane_lookup.glsl"
    };

  public:
    // coating_rows: CoatingSet::rows(); may be empty where nothing is coated.
    explicit LobeModel(std::vector<LobeSlice> tables, std::vector<vec4> coating_rows = {})
        : tables_(std::move(tables)), coating_rows_(std::move(coating_rows)) {}

    Lobe reflected_lobe(int table, float eta, float roughness, const vec3& d, const vec3& n) const {
        return lookup().reflected_lobe(table, eta, roughness, d, n);
    }
    Lobe refracted_lobe(int table, float eta, float roughness, const vec3& d, const vec3& n, int tir) const {
        return lookup().refracted_lobe(table, eta, roughness, d, n, tir);
    }

    CoatingPlace coating_place(const Coating& coating, const vec3& d, const vec3& n) const {
        return lookup().coating_place(coating, d, n);
    }
    CoatingLight coating_light(const CoatingPlace& place) const { return lookup().coating_light(place); }
    int coating_parts(const CoatingTable& table, int group) const {
        return lookup().coating_parts(table, group);
    }
    vec4 coating_part(const CoatingPlace& place, int group, int part) const {
        return lookup().coating_part(place, group, part);
    }
    Lobe coating_lobe(const CoatingTable& table, const CoatingPlace& place, int group, const vec4& part,
                      float side) const {
        return lookup().coating_lobe(table, place, group, part, side);
    }
    PaneLobes pane_lobes(const Pane& pane, const vec3& d, const vec3& n) const {
        return lookup().pane_lobes(pane, d, n);
    }

  private:
    Lookup lookup() const { return {tables_, coating_rows_}; }

    std::vector<LobeSlice> tables_;
    std::vector<vec4> coating_rows_;
};

}  // namespace verglas::model
