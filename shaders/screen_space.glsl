// SPDX-License-Identifier: GPL-3.0-or-later
// Camera space to pixels and back, and where a ray inside an object leaves it: a search in the depth and normal
// of the farthest back faces or, with LAYERS, of the nearest and farthest front and back faces.
#include "geometry_buffer.glsl"

uniform sampler2D front_faces;
uniform sampler2D back_faces;
uniform mat4 projection;
uniform vec2 frame_size;
uniform vec4 object_rect;  // pixels that the shaded object can cover: begin, end
uniform int group;
#ifdef LAYERS
uniform sampler2D nearest_back_faces;
uniform sampler2D farthest_front_faces;
#endif

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

// Whether the pixel can show the object; beyond its rectangle lie others.
bool can_cover(vec3 position, vec2 pixel) {
    bool ahead = position.z < 0.0 || !is_perspective();
    return ahead && all(greaterThanEqual(pixel, object_rect.xy)) && all(lessThan(pixel, object_rect.zw));
}

// Interpolated normals may face away at silhouettes; such a normal is bent until it is seen edge-on.
vec3 toward_viewer(vec3 n, vec3 d) { return normalize(n - max(dot(n, d) + 1e-3, 0.0) * d); }

const vec4 NO_FACE = vec4(-1.0);

// Farthest back face under a point; w is negative where the object has none.
vec4 back_face(vec3 position) {
    vec2 pixel = pixel_of(position);
    return can_cover(position, pixel) ? texelFetch(back_faces, ivec2(pixel), 0) : NO_FACE;
}

#ifdef LAYERS
// The back of what a pixel shows the front of.
vec4 first_back_face(ivec2 pixel) { return texelFetch(nearest_back_faces, pixel, 0); }

// The face through which a ray along d leaves that has come to a point: the first front where the point lies before
// it, else the first back, and the last back where it lies within the last layer of glass. epsilon: in units of depth.
vec4 face_to_leave_by(vec3 position, vec3 d, float epsilon) {
    vec2 place = pixel_of(position);
    if (!can_cover(position, place)) return NO_FACE;
    ivec2 pixel = ivec2(place);
    vec4 nearest_back = texelFetch(nearest_back_faces, pixel, 0);
    float depth = -position.z;
    vec4 front = texelFetch(front_faces, pixel, 0);
    bool is_own = front.w >= 0.0 && decode_group(front.w) == group;
    if (nearest_back.w >= 0.0 && is_own && depth < front.z - epsilon)
        return dot(decode_normal(front.xy), d) > 0.0 ? front : NO_FACE;
    if (nearest_back.w < 0.0 || depth <= nearest_back.z) return nearest_back;
    bool is_between = depth < texelFetch(farthest_front_faces, pixel, 0).z;
    return is_between ? nearest_back : texelFetch(back_faces, pixel, 0);
}

// Beyond the silhouette nothing is known of the surface but that it is seen edge-on.
vec2 edge_on_normal(vec3 position, vec3 d, vec2 otherwise) {
    vec3 v = view_direction(position);
    vec3 n = d - dot(d, v) * v;
    return dot(n, n) > 1e-4 ? encode_normal(normalize(n)) : otherwise;
}
#else
vec4 first_back_face(ivec2 pixel) { return texelFetch(back_faces, pixel, 0); }
vec4 face_to_leave_by(vec3 position, vec3 d, float epsilon) { return back_face(position); }
vec2 edge_on_normal(vec3 position, vec3 d, vec2 otherwise) { return otherwise; }
#endif

// Where a ray leaves: the distance along it and the back face there (of the geometry buffer).
struct Exit {
    float t;
    vec4 face;
};

// A tangent plane seen at a flat angle says little about where the ray meets the surface.
const float MIN_SLOPE = 0.1;

// Newton steps on the tangent plane of the face under the ray's point. guess: where to begin, with the
// back face there. bound: no exit is farther.
Exit find_exit_newton(vec3 origin, vec3 d, Exit guess, int steps, float bound) {
    Exit found = guess;
    float t = guess.t;
    bool beyond = false;
    for (int i = 0; i <= steps; ++i) {
        vec3 x = origin + t * d;
        vec4 face = face_to_leave_by(x, d, 1e-4 * bound);
        if (face.w < 0.0) {
            // Beyond the silhouette: back toward the last point over the object.
            t = 0.5 * (t + found.t);
            beyond = true;
            continue;
        }
        // Only a point past the last one tells that the object goes on there.
        beyond = beyond && t <= found.t;
        found = Exit(t, face);
        vec3 n = decode_normal(face.xy);
        t = clamp(dot(n, at_depth(x, face.z) - origin) / max(dot(n, d), MIN_SLOPE), 1e-4 * bound, bound);
    }
    if (beyond) found.face.xy = edge_on_normal(origin + found.t * d, d, found.face.xy);
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
