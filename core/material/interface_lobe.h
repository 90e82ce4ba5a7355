// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/material/lobe_tables.h"
#include "core/material/model.h"
#include "core/scene/settings.h"

namespace verglas {

// The lobe that the renderer takes for a rough interface, in its frame: n = +Z, and the viewer at o = (sin
// theta_o, 0, cos theta_o). roughness: 0 … 1; eta: n_behind / n_before, clamped as by LobeTables;
// cos_theta_o: 0 … 1. Beyond the critical angle a refraction keeps what the rough interface lets through.
// lobes: from where. Tables stay loaded. Throws Error for values out of range.
model::Lobe interface_lobe(Ndf ndf, float roughness, float eta, float cos_theta_o, LobeEvent event,
                           Lobes lobes = Lobes::Table);

}  // namespace verglas
