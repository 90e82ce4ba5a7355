// SPDX-License-Identifier: GPL-3.0-or-later
// Normals that textures bend, with the meaning that Blender's nodes Normal Map and Bump have in Cycles. n: the unit
// normal that is bent, on the outside of the surface.

SHARED vec3 unit_or(vec3 v, vec3 otherwise) {
    float square = dot(v, v);
    return square > 0.0f ? v / sqrt(square) : otherwise;
}

// Axes of a normal map in tangent space, made of interpolated vectors, which need not be of unit length. tangent: as
// ReliefCoordinates::tangents of core/scene/relief.h.
SHARED mat3 tangent_frame(vec3 normal, vec4 tangent) {
    vec3 t = vec3(tangent.x, tangent.y, tangent.z);
    return mat3(t, tangent.w * cross(normal, t), normal);
}

// A tangent space map's direction, whose slopes are made steeper: Cycles' and EEVEE's strength from Blender 4.0 on.
SHARED vec3 steepened(vec3 direction, float steepness) {
    return vec3(steepness * direction.x, steepness * direction.y, 1.0f + min(steepness, 1.0f) * (direction.z - 1.0f));
}

// axes: those of the map's colour. steepness: as steepened's; 1 in other spaces. strength: 0 for n, 1 for the map's
// normal.
SHARED vec3 mapped_normal(vec3 n, mat3 axes, vec3 color, float steepness, float strength) {
    vec3 mapped = unit_or(axes * steepened(2.0f * color - 1.0f, steepness), n);
    return unit_or(n + strength * (mapped - n), n);
}

// n less the gradient of the height over the surface (Mikkelsen: Bump Mapping Unparametrized Surfaces on the GPU,
// 2010). along_1, along_2: two vectors in the surface, along which the height rises by rise_1 and rise_2, in the same
// units.
SHARED vec3 bumped_normal(vec3 n, vec3 along_1, vec3 along_2, float rise_1, float rise_2, float strength) {
    vec3 across_1 = cross(along_2, n);
    vec3 across_2 = cross(n, along_1);
    float area = dot(along_1, across_1);
    if (area == 0.0f) return n;
    vec3 gradient = (rise_1 * across_1 + rise_2 * across_2) / area;
    return unit_or(n + strength * (unit_or(n - gradient, n) - n), n);
}

// n turned toward the triangle's normal g until the surface mirrors the viewer to outside of itself, as Cycles does it
// with bent normals. g: on the viewer's side. o: unit direction to the viewer. In the plane of g and n, where n has the
// angle phi from g and o the projection a (sin beta, cos beta), the mirror image's cosine to g is a cos(2 phi - beta).
SHARED vec3 mirroring_normal(vec3 n, vec3 g, vec3 o) {
    float o_g = dot(o, g);
    float least = min(0.9f * o_g, 0.01f);
    if (2.0f * dot(n, o) * dot(n, g) - o_g >= least) return n;
    vec3 x = unit_or(n - dot(n, g) * g, n);
    float o_x = dot(o, x);
    float a = max(sqrt(o_x * o_x + o_g * o_g), 1e-12f);
    float phi = 0.5f * (atan(o_x, o_g) + acos(clamp(least / a, -1.0f, 1.0f)));
    return sin(phi) * x + cos(phi) * g;
}
