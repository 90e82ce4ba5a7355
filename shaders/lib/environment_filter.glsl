// SPDX-License-Identifier: GPL-3.0-or-later
// The kernel that prefilters the environment: a spherical Gaussian about a target, summed over the blocks of columns
// of a source, band by band (core/environment/level_plan.h). Angles a are counted from the lower pole; u is azimuth.
// The including code provides
//     void add_block(int block, float weight)    // block: from -blocks to 2 blocks, modulo the band's blocks

// 1 - cos(gamma) at the kernel's end, where it has fallen to exp(-cut) of its peak. Wide kernels reach on, since dark
// places may be lit by their tails alone, and are cheap. More than 2, the most there is, where the kernel covers the
// sphere: its opposite point counts much then, and must not fall to rounding.
SHARED float kernel_reach(float kappa) { return (kappa > 1000.0f ? 7.0f : 16.0f) / kappa; }

// Adds what the target gathers from a band; false where the kernel doesn't reach it.
// half_angle: sin(a / 2), cos(a / 2) of the target; place: sin(a' / 2), cos(a' / 2), solid angle of a block, number of
// blocks of the band; azimuth of block b: (b + block_center) 2 pi / blocks.
SHARED bool add_band(vec2 half_angle, float azimuth, float reach, vec4 place, float kappa, float block_center) {
    // 1 - cos(gamma) = 2 sin^2((a - a') / 2) + 2 sin a sin a' sin^2((u - u') / 2) <= reach
    float s = half_angle.x * place.y - half_angle.y * place.x;
    float remaining = 0.5f * reach - s * s;
    if (remaining < 0.0f) return false;
    float sines = 4.0f * half_angle.x * half_angle.y * place.x * place.y;
    float block_width = 2.0f * PI / place.w;
    bool whole_ring = remaining >= sines;
    float reach_azimuth = whole_ring ? PI : 2.0f * asin(sqrt(remaining / sines));
    int first = int(ceil((azimuth - reach_azimuth) / block_width - block_center));
    int last = first + int(place.w) - 1;
    if (!whole_ring) last = min(int(floor((azimuth + reach_azimuth) / block_width - block_center)), last);
    // sin((u' - u) / 2) by rotation from block to block.
    float start = 0.5f * ((float(first) + block_center) * block_width - azimuth);
    vec2 turn = vec2(sin(start), cos(start));
    vec2 turn_step = vec2(sin(0.5f * block_width), cos(0.5f * block_width));
    float factor = -2.0f * kappa * sines;
    float exponent = -2.0f * kappa * s * s;
    for (int i = first; i <= last; ++i) {
        add_block(i, place.z * exp(exponent + factor * turn.x * turn.x));
        turn = vec2(turn.x * turn_step.y + turn.y * turn_step.x, turn.y * turn_step.y - turn.x * turn_step.x);
    }
    return true;
}
