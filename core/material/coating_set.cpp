// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/material/coating_set.h"

#include <utility>

namespace verglas {

bool CoatingSet::update(const std::vector<Material>& materials) {
    std::map<CoatingKey, std::shared_ptr<const CoatingTable>> kept;
    bool changed = false;
    for (const Material& material : materials) {
        if (material.kind != MaterialKind::Coated) continue;
        const CoatingKey key(material);
        if (kept.count(key) > 0) continue;
        const auto known = tables_.find(key);
        changed = changed || known == tables_.end();
        kept[key] = known != tables_.end() ? known->second
                                           : std::make_shared<const CoatingTable>(CoatingTable::build(key));
    }
    changed = changed || kept.size() != tables_.size();
    tables_ = std::move(kept);
    if (changed) rows_.clear();
    std::map<CoatingKey, model::CoatingTable> placed;
    int row = 0;
    for (const auto& [key, table] : tables_) {
        model::CoatingTable& layout = placed[key] = table->layout;
        layout.first_row = row;
        row += layout.outer_nodes * layout.base_nodes;
        if (changed) rows_.insert(rows_.end(), table->nodes.begin(), table->nodes.end());
    }
    of_materials_.clear();
    for (const Material& material : materials)
        of_materials_.push_back(material.kind == MaterialKind::Coated ? placed[CoatingKey(material)]
                                                                      : model::CoatingTable{});
    return changed;
}

}  // namespace verglas
