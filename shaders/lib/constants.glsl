// SPDX-License-Identifier: GPL-3.0-or-later
// The files of this folder are GLSL and, through core/math/glsl.h, C++: float literals carry an f, no
// swizzles, and SHARED before every function (nothing in GLSL, `inline` in C++).

const float PI = 3.14159265358979f;

// Normal distributions of microfacets (Walter et al. 2007, section 5.2).
const int NDF_BECKMANN = 0;
const int NDF_GGX = 1;
const int NDF_BLINN_PHONG = 2;

const int NDF_COUNT = 3;

// What a rough interface does with light.
const int EVENT_REFRACT = 0;          // weighted with 1 - F: glass
const int EVENT_REFRACT_WITHOUT = 1;  // without Fresnel factor: Blender's Refraction BSDF
const int EVENT_REFLECT = 2;          // weighted with F

// Greatest roughness, kappa = 1: of coatings; glass has up to 1.
const float MAX_ROUGHNESS = 1.1892071f;

// What stands behind a surface (MaterialKind of core/scene/scene.h).
const int KIND_SOLID = 0;
const int KIND_PANE = 1;
const int KIND_COATED = 2;

// What becomes of rays beyond the critical angle (de Rousiers et al. 2012, Fig. 18).
const int TIR_NONE = 0;
const int TIR_INCIDENT = 1;
const int TIR_CLAMP = 2;  // also where 3, bounce, can't be had (shaders/bounce.glsl)
