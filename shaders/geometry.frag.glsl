// SPDX-License-Identifier: GPL-3.0-or-later
// Front or back faces into a geometry buffer.
#include "geometry_buffer.glsl"

in vec3 view_position;
in vec3 view_normal;

uniform int group;
uniform int material;

layout(location = 0) out vec4 texel;

void main() { texel = vec4(encode_normal(view_normal), -view_position.z, encode_index(group, material)); }
