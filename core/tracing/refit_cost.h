// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/scene/mesh.h"

namespace verglas {

// How many times as long rays take in a tree that was built for one mesh and refit to another than in a tree
// built for the other: about 1 after bending, 2 after twisting by a turn or so. The meshes differ in nothing
// but positions. An estimate from a few thousand triangles: the surface areas of the boxes of a tree over
// them (the surface area heuristic; Goldsmith and Salmon 1987), with the triangles in the order of a Morton
// curve through where they were, over the same in the order in which they are.
float refit_cost(const Mesh& built, const Mesh& moved);

}  // namespace verglas
