// SPDX-License-Identifier: GPL-3.0-or-later
// How an environment map is prefiltered, for both devices (de Rousiers et al. 2012, section 4.1): which
// levels there are, what each is filtered from, and with which kernel.
//
// Level 0 has the concentration of a Gaussian 1.5 texels wide; each level is filtered from a sharper one,
// with the kernel that A3(kappa_ab) = A3(kappa_a) A3(kappa_b) asks for.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/scene/environment_map.h"

namespace verglas {

// A level of the prefiltered environment; see shaders/lib/environment.glsl.
struct EnvironmentLevel {
    float kappa = 0.0F;
    // columns and intervals between rows of the lattice; it has one texel more in either direction.
    int columns = 0;
    int intervals = 0;
    int first_row = 0;  // where all levels lie above each other in one atlas
};

// From the sharpest to the bluntest. columns: those of the picture that level 0 is filtered from.
std::vector<EnvironmentLevel> plan_levels(int columns);

// A row of a source, or a part of one, whose columns count in blocks; as shaders/lib/environment_filter.glsl
// reads it.
struct EnvironmentBand {
    glm::vec4 place;   // sin(a / 2), cos(a / 2), solid angle of a block, number of blocks
    glm::vec4 source;  // row, kappa of the kernel
};

// What a level is filtered from, and with which kernel.
struct EnvironmentSource {
    int level = 0;                       // map_source: the map itself
    int columns = 0;                     // those that blocks are made of
    float block_center = 0.0F;           // azimuth of block b is (b + block_center) 2 pi / blocks
    std::vector<EnvironmentBand> bands;  // from the lower pole up
    float kappa = 0.0F;                  // the smallest of all bands
};
constexpr int map_source = -1;

EnvironmentSource plan_source(const std::vector<EnvironmentLevel>& levels, int level);

// The picture that level 0 is filtered from, a power of two wide and half as high: the map with every texel
// the mean over its solid angle, and with the radiance of each block in its first column.
struct EnvironmentPicture {
    int columns = 0;
    std::vector<glm::vec3> pixels;
};

EnvironmentPicture make_source_picture(const EnvironmentMap& map);

}  // namespace verglas
