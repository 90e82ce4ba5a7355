// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/material/lobe_tables.h"
#include "core/material/model.h"

namespace verglas::model {

// The part of shaders/lib that reads lobe tables, for C++: its functions are members here, and not
// const, for which GLSL has no word.
class LobeModel {
  public:
    explicit LobeModel(std::vector<LobeSlice> tables) : tables_(std::move(tables)) {}

    // Bilinear interpolation, as GL_LINEAR does with nodes at the centres of texels.
    vec4 sample_lobe_table(int table, float x, float y) const {
        const float column = clamp(x, 0.0F, 1.0F) * (LOBE_COSINES - 1);
        const float row = clamp(y, 0.0F, 1.0F) * (LOBE_ROUGHNESSES - 1);
        const int i = std::min(static_cast<int>(column), LOBE_COSINES - 2);
        const int j = std::min(static_cast<int>(row), LOBE_ROUGHNESSES - 2);
        const vec4* node = &tables_[table][j * LOBE_COSINES + i];
        const float t = column - static_cast<float>(i);
        return mix(mix(node[0], node[1], t), mix(node[LOBE_COSINES], node[LOBE_COSINES + 1], t),
                   row - static_cast<float>(j));
    }

#include "shaders/lib/lobe_lookup.glsl"

  private:
    std::vector<LobeSlice> tables_;
};

}  // namespace verglas::model
