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

// The kernel ends where it has fallen to exp(-cut) of its peak. Wide ones reach on, since dark places may be lit by
// their tails alone, and are cheap.
float kernel_cut() { return kappa > 1000.0 ? 7.0 : 16.0; }

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

    // 1 - cos(gamma) = 2 sin^2((a - a') / 2) + 2 sin a sin a' sin^2((u - u') / 2) <= reach
    float reach = min(kernel_cut() / kappa, 2.0);
    float reach_angle = acos(1.0 - reach);
    int band_count = textureSize(bands, 0).y;

    vec3 sum = vec3(0.0);
    float weight_sum = 0.0;
    for (int band = first_band(angle - reach_angle); band < band_count; ++band) {
        vec4 info = texelFetch(bands, ivec2(0, band), 0);
        float s = half_angle.x * info.y - half_angle.y * info.x;
        float remaining = 0.5 * reach - s * s;
        if (remaining < 0.0) {
            if (s < 0.0) break;
            continue;
        }
        vec2 source_band = texelFetch(bands, ivec2(1, band), 0).xy;
        int row = int(source_band.x);
        float sines = 4.0 * half_angle.x * half_angle.y * info.x * info.y;
        float block_width = 2.0 * PI / info.w;
        float reach_azimuth = 2.0 * asin(sqrt(min(remaining / max(sines, 1e-12), 1.0)));
        int blocks = int(info.w);
        int block = source_columns / blocks;
        int first = int(ceil((azimuth - reach_azimuth) / block_width - block_center));
        int last = min(int(floor((azimuth + reach_azimuth) / block_width - block_center)), first + blocks - 1);
        // sin((u' - u) / 2) by rotation from block to block.
        float start = 0.5 * ((float(first) + block_center) * block_width - azimuth);
        vec2 turn = vec2(sin(start), cos(start));
        vec2 turn_step = vec2(sin(0.5 * block_width), cos(0.5 * block_width));
        float factor = -2.0 * source_band.y * sines;
        float exponent = -2.0 * source_band.y * s * s;
        for (int i = first; i <= last; ++i) {
            float weight = info.z * exp(exponent + factor * turn.x * turn.x);
            turn = vec2(turn.x * turn_step.y + turn.y * turn_step.x, turn.y * turn_step.y - turn.x * turn_step.x);
            int wrapped = i < 0 ? i + blocks : (i >= blocks ? i - blocks : i);
            sum += weight * texelFetch(source, ivec2(wrapped * block, row), 0).rgb;
            weight_sum += weight;
        }
    }
    radiance = vec4(sum / weight_sum, 1.0);
}
