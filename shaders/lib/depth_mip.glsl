// SPDX-License-Identifier: GPL-3.0-or-later
// The baseline DEPTH_MIP: one ray crosses the object by Snell's law, and the environment is looked up at a level that
// roughness and the distance travelled inside fix (Eisemann and Decoret 2006, as de Rousiers et al. 2012 describe them
// in Fig. 17, who don't say which level). To be fair to it, energies are those of the rough interfaces, and the level
// is the best found that grows with the distance: the rough back's width at straight incidence, to which the front
// adds its own in proportion to the distance. If the whole width grew so, spheres would fit as well, and slabs worse.

// Fitted to path-traced pictures of the sample scene of the sphere, without total internal reflection, of roughness
// 0.1, 0.25, 0.55 and 0.8 under three environment maps: the least mean logarithm of their relative errors, which is
// flat from 2.5 to 4.
const float DEPTH_MIP_FACTOR = 3.2f;

// Spread of the exit lobe. front_spread, back_spread: of the interfaces' lobes at straight incidence; depth:
// distance travelled inside; size: diagonal of the object's bounding box.
SHARED float depth_mip_spread(float front_spread, float back_spread, float depth, float size) {
    float spread = back_spread + DEPTH_MIP_FACTOR * (depth / size) * front_spread;
    return clamp(spread, LOBE_MIN_SPREAD, 1.0f);
}
