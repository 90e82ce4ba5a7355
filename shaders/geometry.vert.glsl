// SPDX-License-Identifier: GPL-3.0-or-later

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 texture_uv;

uniform mat4 model_to_view;
uniform mat3 normal_to_view;
uniform mat4 projection;

out vec3 view_position;
out vec3 view_normal;
out vec2 uv;

void main() {
    vec4 p = model_to_view * vec4(position, 1.0);
    view_position = p.xyz;
    view_normal = normal_to_view * normal;
    uv = texture_uv;
    gl_Position = projection * p;
}
