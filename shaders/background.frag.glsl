// SPDX-License-Identifier: GPL-3.0-or-later
// A finished sample: what was shaded, and the environment where nothing is; added to the frame by blending.
#include "environment.glsl"
#include "screen_space.glsl"

uniform sampler2D shaded;
uniform float background_alpha;
uniform float background_spread;

layout(location = 0) out vec4 radiance;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    if (texelFetch(front_faces, at, 0).w >= 0.0)
        radiance = texelFetch(shaded, at, 0);
    else if (background_alpha == 0.0)
        radiance = vec4(0.0);
    else {
        vec3 direction = view_direction(position_at(gl_FragCoord.xy, 1.0));
        radiance = background_alpha * vec4(incoming_radiance(direction, background_spread), 1.0);
    }
}
