// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/tracing/bundle_tracer.h"

namespace verglas {

// Averages each pixel that shows a surface with its neighbours that show the same, 1-2-1 in either direction:
// the sum over every 2 x 2 pattern of turned bundles has the same weight for all four. Normals may differ by
// several widths of the microfacets' distribution, since lobes blur what lies behind by more than that.
void average_surfaces(TracedPicture& picture);

}  // namespace verglas
