// SPDX-License-Identifier: GPL-3.0-or-later
// Normal in world space and depth, for compositing.
#include "geometry_buffer.glsl"

uniform sampler2D front_faces;
uniform mat3 view_to_world;

layout(location = 0) out vec4 normal_depth;

const float NO_DEPTH = 1e10;

void main() {
    vec4 face = texelFetch(front_faces, ivec2(gl_FragCoord.xy), 0);
    normal_depth = face.w < 0.0 ? vec4(0.0, 0.0, 0.0, NO_DEPTH) : vec4(view_to_world * decode_normal(face.xy), face.z);
}
