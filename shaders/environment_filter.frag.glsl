// SPDX-License-Identifier: GPL-3.0-or-later
// One level of the prefiltered environment: the source convolved with a spherical Gaussian, by a sum over all
// source texels that it reaches, each with its solid angle. Near the poles, where columns crowd, a block of them
// counts as one, so that the cost of a texel is the same everywhere.
#include "lib/constants.glsl"

uniform sampler2D source;
// Two texels for each band of the source, from the lower pole up: (sin(a / 2), cos(a / 2), solid angle of one block,
// number of blocks), where a is the band's angle from the lower pole, and (row of the source, kappa of the kernel).
// The first column of a block holds its radiance.
uniform sampler2D bands;
uniform int source_columns;
uniform float block_center;  // within a block, in its width: azimuth of block b is (b + block_center) 2 pi / blocks
uniform ivec2 target_size;   // columns and intervals between rows of the target's lattice
uniform float kappa;         // of the kernel, the smallest of all bands

layout(location = 0) out vec4 radiance;

vec3 sum = vec3(0.0);
float weight_sum = 0.0;
int row;    // of the band
int block;  // its width in columns

void add_block(int b, float weight) {
    int column = b * block;
    column += column < 0 ? source_columns : (column >= source_columns ? -source_columns : 0);
    sum += weight * texelFetch(source, ivec2(column, row), 0).rgb;
    weight_sum += weight;
}

#include "lib/environment_filter.glsl"

// The first band whose angle may exceed the given one.
int first_band(float angle) {
    int count = textureSize(bands, 0).y;
    int low = 0;
    int high = count - 1;
    float sine = sin(0.5 * max(angle, 0.0));
    while (low < high) {
        int middle = (low + high) / 2;
        if (texelFetch(bands, ivec2(0, middle), 0).x < sine)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

void main() {
    // The last column of the target repeats the first.
    int column = int(gl_FragCoord.x);
    float azimuth = column == target_size.x ? 0.0 : 2.0 * PI * float(column) / float(target_size.x);
    float angle = PI * float(int(gl_FragCoord.y)) / float(target_size.y);
    vec2 half_angle = vec2(sin(0.5 * angle), cos(0.5 * angle));

    float reach = kernel_reach(kappa);
    int band_count = textureSize(bands, 0).y;
    int first = reach < 2.0 ? first_band(angle - acos(1.0 - reach)) : 0;
    for (int band = first; band < band_count; ++band) {
        vec4 place = texelFetch(bands, ivec2(0, band), 0);
        vec4 from = texelFetch(bands, ivec2(1, band), 0);
        row = int(from.x);
        block = source_columns / int(place.w);
        bool reached = add_band(half_angle, azimuth, reach, place, from.y, block_center);
        if (!reached && place.x > half_angle.x) break;
    }
    radiance = vec4(sum / weight_sum, 1.0);
}
