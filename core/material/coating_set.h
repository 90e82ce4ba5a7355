// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "core/material/coating_table.h"

namespace verglas {

// The tables that the coated materials of a scene need, each once, one below the other.
class CoatingSet {
  public:
    // Whether the rows have changed.
    bool update(const std::vector<Material>& materials);

    // Of all tables: COATING_ITEMS * COATING_ANGLES nodes each. Empty where nothing is coated.
    const std::vector<glm::vec4>& rows() const { return rows_; }

    // Of a coated material.
    const model::CoatingTable& table(int material) const { return of_materials_[material]; }

  private:
    std::map<CoatingKey, std::shared_ptr<const CoatingTable>> tables_;
    std::vector<glm::vec4> rows_;
    std::vector<model::CoatingTable> of_materials_;
};

}  // namespace verglas
