// SPDX-License-Identifier: GPL-3.0-or-later

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 texture_uv;
#ifdef RELIEF
layout(location = 3) in vec2 normal_texture_uv;
layout(location = 4) in vec4 tangent;
layout(location = 5) in vec2 height_texture_uv;
#endif

uniform mat4 model_to_view;
uniform mat3 normal_to_view;
uniform mat4 projection;

out vec3 view_position;
out vec3 view_normal;
out vec2 uv;
#ifdef RELIEF
out vec3 object_normal;
out vec4 object_tangent;
out vec2 normal_uv;
out vec2 height_uv;
#endif

void main() {
    vec4 p = model_to_view * vec4(position, 1.0);
    view_position = p.xyz;
    view_normal = normal_to_view * normal;
    uv = texture_uv;
#ifdef RELIEF
    object_normal = normal;
    object_tangent = tangent;
    normal_uv = normal_texture_uv;
    height_uv = height_texture_uv;
#endif
    gl_Position = projection * p;
}
