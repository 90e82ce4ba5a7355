// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/tracing/bundle_tracer.h"

namespace verglas {

// Mean radiance of a pixel and of its neighbours that show the same surface, 1-2-1 in either direction: the
// sum over every 2 x 2 pattern of turned bundles has the same weight for all four. Normals may differ by
// several widths of the microfacets' distribution, since lobes blur what lies behind by more than that. The
// pixel's own where it shows no surface.
glm::vec3 average_over_surface(const TracedPicture& picture, glm::ivec2 pixel);

}  // namespace verglas
