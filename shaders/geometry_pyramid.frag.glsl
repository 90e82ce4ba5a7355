// SPDX-License-Identifier: GPL-3.0-or-later
// A level of the pyramid over the back faces (de Rousiers et al. 2012, section 4.2): normals times coverage, whose
// length is the spread of the distribution of normals, coverage, and the least and greatest depth.
#include "geometry_buffer.glsl"

#ifdef BASE
uniform sampler2D back_faces;
#else
uniform sampler2D finer_normals;
uniform sampler2D finer_depths;
#endif

layout(location = 0) out vec4 normal;  // premultiplied by coverage, coverage
layout(location = 1) out vec2 depths;

const float NOTHING = 1e30;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
#ifdef BASE
    vec4 texel = texelFetch(back_faces, at, 0);
    bool covered = texel.w >= 0.0;
    normal = covered ? vec4(decode_normal(texel.xy), 1.0) : vec4(0.0);
    depths = covered ? texel.zz : vec2(NOTHING, -NOTHING);
#else
    // Where a side is odd, the last texel has three below it.
    ivec2 size = textureSize(finer_normals, 0);
    ivec2 begin = at * 2;
    ivec2 end = min(begin + 2 + ivec2(equal(begin + 3, size)), size);
    normal = vec4(0.0);
    depths = vec2(NOTHING, -NOTHING);
    for (int y = begin.y; y < end.y; ++y) {
        for (int x = begin.x; x < end.x; ++x) {
            normal += texelFetch(finer_normals, ivec2(x, y), 0);
            vec2 range = texelFetch(finer_depths, ivec2(x, y), 0).xy;
            depths = vec2(min(depths.x, range.x), max(depths.y, range.y));
        }
    }
    ivec2 count = end - begin;
    normal /= float(count.x * count.y);
#endif
}
