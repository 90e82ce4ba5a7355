// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/material/model.h"

namespace verglas::model {

// The part of shaders/lib that looks up the lobes of coatings, for C++. Any number of threads may look up at
// the same time.
class CoatingModel {
    // Its functions aren't const, for which GLSL has no word.
    struct Lookup {
        const std::vector<vec4>& rows;

        vec4 sample_coating_row(float column, int row) const {
            constexpr int width = COATING_ITEMS * COATING_ANGLES;
            const int i = std::min(static_cast<int>(column), width - 2);
            const vec4* node = &rows[std::size_t(row) * width + i];
            return mix(node[0], node[1], column - static_cast<float>(i));
        }

#include "shaders/lib/coated_lookup.glsl"
    };

  public:
    // rows: CoatingSet::rows(); may be empty where nothing is coated, and then nothing may be looked up.
    explicit CoatingModel(std::vector<vec4> rows) : rows_(std::move(rows)) {}

    CoatingPlace coating_place(const Coating& coating, const vec3& d, const vec3& n) const {
        return lookup().coating_place(coating, d, n);
    }
    CoatingLight coating_light(const CoatingTable& table, const CoatingPlace& place) const {
        return lookup().coating_light(table, place);
    }
    Lobe coating_part(const CoatingTable& table, const CoatingPlace& place, int group, int part,
                      float further) const {
        return lookup().coating_part(table, place, group, part, further);
    }
    Lobe coating_lobe(const CoatingPlace& place, const Lobe& part, float side) const {
        return lookup().coating_lobe(place, part, side);
    }

  private:
    Lookup lookup() const { return {rows_}; }

    std::vector<vec4> rows_;
};

}  // namespace verglas::model
