// SPDX-License-Identifier: GPL-3.0-or-later
// Camera space to pixels and back, and where a ray inside an object leaves it: a search in the depth and normal
// of the farthest back faces.
#include "geometry_buffer.glsl"

uniform sampler2D front_faces;
uniform sampler2D back_faces;
uniform mat4 projection;
uniform vec2 frame_size;
uniform vec4 object_rect;  // pixels that the shaded object can cover: begin, end

bool is_perspective() { return projection[3][3] == 0.0; }

// Pixel coordinates of a point.
vec2 pixel_of(vec3 position) {
    vec4 clip = projection * vec4(position, 1.0);
    return (0.5 + 0.5 * clip.xy / clip.w) * frame_size;
}

// Point at a depth (distance along the camera's axis) seen in a pixel.
vec3 position_at(vec2 pixel, float depth) {
    float w = is_perspective() ? depth : 1.0;
    vec2 clip = (2.0 * pixel / frame_size - 1.0) * w;
    vec2 offset = vec2(projection[3][0] - projection[2][0] * depth, projection[3][1] - projection[2][1] * depth);
    return vec3((clip - offset) / vec2(projection[0][0], projection[1][1]), -depth);
}

// Unit direction from the camera through a point.
vec3 view_direction(vec3 position) { return is_perspective() ? normalize(position) : vec3(0.0, 0.0, -1.0); }

// The point at another depth on the line of sight through a point.
vec3 at_depth(vec3 position, float depth) {
    return is_perspective() ? position * (depth / -position.z) : vec3(position.xy, -depth);
}

// Back faces under a point; w is negative where the object has none. Beyond its rectangle lie those of others.
vec4 back_face(vec3 position) {
    vec2 pixel = pixel_of(position);
    bool inside = position.z < 0.0 || !is_perspective();
    inside = inside && all(greaterThanEqual(pixel, object_rect.xy)) && all(lessThan(pixel, object_rect.zw));
    return inside ? texelFetch(back_faces, ivec2(pixel), 0) : vec4(-1.0);
}

// Where a ray leaves: the distance along it and the back face there (of the geometry buffer).
struct Exit {
    float t;
    vec4 face;
};

// A tangent plane seen at a flat angle says little about where the ray meets the surface.
const float MIN_SLOPE = 0.1;

// Newton steps on the tangent plane of the back face under the ray's point. guess: where to begin, with the
// back face there. bound: no exit is farther.
Exit find_exit_newton(vec3 origin, vec3 d, Exit guess, int steps, float bound) {
    Exit found = guess;
    float t = guess.t;
    for (int i = 0; i < steps; ++i) {
        vec3 x = origin + t * d;
        vec4 face = back_face(x);
        if (face.w < 0.0) {
            // Beyond the silhouette: back toward the last point over the object.
            t = 0.5 * (t + found.t);
            continue;
        }
        vec3 n = decode_normal(face.xy);
        found = Exit(t, face);
        t = clamp(dot(n, at_depth(x, face.z) - origin) / max(dot(n, d), MIN_SLOPE), 1e-4 * bound, bound);
    }
    vec4 face = back_face(origin + t * d);
    if (face.w >= 0.0) found = Exit(t, face);
    return found;
}

const int MARCH_STEPS = 14;
const int MARCH_HALVINGS = 6;

// Linear and binary search for the first point below the back faces (Oliveira and Brauwers 2007).
Exit find_exit_march(vec3 origin, vec3 d, Exit guess, float bound) {
    float near = 0.0;
    float far = bound;
    for (int i = 1; i <= MARCH_STEPS; ++i) {
        float t = bound * float(i) / float(MARCH_STEPS);
        vec3 x = origin + t * d;
        vec4 face = back_face(x);
        if (face.w < 0.0 || -x.z > face.z) {
            far = t;
            break;
        }
        near = t;
        guess = Exit(t, face);
    }
    for (int i = 0; i < MARCH_HALVINGS; ++i) {
        float t = 0.5 * (near + far);
        vec3 x = origin + t * d;
        vec4 face = back_face(x);
        bool below = face.w < 0.0 || -x.z > face.z;
        if (face.w >= 0.0) guess = Exit(t, face);
        if (below)
            far = t;
        else
            near = t;
    }
    return guess;
}
