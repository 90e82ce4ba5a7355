// SPDX-License-Identifier: GPL-3.0-or-later
// The finest level of what behind.glsl reads.
uniform sampler2D front_faces;
uniform sampler2D shaded;

layout(location = 0) out vec4 radiance;
layout(location = 1) out float depth;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 face = texelFetch(front_faces, pixel, 0);
    bool covered = face.w >= 0.0;
    radiance = covered ? vec4(texelFetch(shaded, pixel, 0).rgb, 1.0) : vec4(0.0);
    depth = covered ? face.z : 0.0;
}
