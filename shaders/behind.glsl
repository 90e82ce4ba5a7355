// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen of the scene through a pane: its picture without panes, blurred as far as a lobe has spread at the
// distance of what is there. Beside the picture and behind what is in front, nothing is known of it. The including code
// has screen_space.glsl.

uniform sampler2D behind_radiance;  // with mipmaps; a: the part that is covered, by which rgb is multiplied
uniform sampler2D behind_depth;     // likewise multiplied

// Rings of points under a Gaussian, in its standard deviations, and their weights.
const int BEHIND_RINGS = 2;
const int BEHIND_POINTS = 6;

// The level whose texels are nearly as wide as a blur in pixels.
float behind_level(float blur) {
    return clamp(log2(max(0.8 * blur, 1.0)), 0.0, float(textureQueryLevels(behind_radiance) - 1));
}

vec4 behind_at(vec2 pixel, float level) {
    vec2 uv = pixel / frame_size;
    bool inside = all(greaterThan(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0)));
    return inside ? textureLod(behind_radiance, uv, level) : vec4(0.0);
}

// Where a lobe from a pane meets what is behind it.
struct Behind {
    vec2 pixel;
    float blur;  // standard deviation in pixels
    bool found;
};

Behind find_behind(vec3 position, vec3 direction, float spread) {
    const int STEPS = 3;
    float sigma = sqrt(spread);
    float scale = 0.5 * projection[1][1] * frame_size.y;  // pixels by unit of length, at depth 1 in perspective
    // First as if all were far away, where the pane is seen.
    Behind behind = Behind(pixel_of(position), is_perspective() ? sigma * scale : frame_size.y, false);
    float depth = -position.z;
    float forward = -min(direction.z, -0.05);
    for (int i = 0; i < STEPS; ++i) {
        float level = behind_level(behind.blur);
        float covered = behind_at(behind.pixel, level).a;
        if (covered > 1e-4) {
            depth = textureLod(behind_depth, behind.pixel / frame_size, level).x / covered;
            behind.found = true;
        }
        float t = max((depth + position.z) / forward, 0.0);
        behind.pixel = pixel_of(position + t * direction);
        behind.blur = sigma * t * scale / (is_perspective() ? max(depth, 1e-6) : 1.0);
    }
    return behind;
}

// Light from there, and how much of the lobe it fills.
vec4 radiance_behind(vec3 position, vec3 direction, float spread) {
    Behind behind = find_behind(position, direction, spread);
    if (!behind.found) return vec4(0.0);
    float level = behind_level(behind.blur);
    vec4 sum = behind_at(behind.pixel, level);
    float weights = 1.0;
    for (int ring = 1; ring <= BEHIND_RINGS; ++ring) {
        float weight = exp(-0.5 * float(ring * ring));
        for (int i = 0; i < BEHIND_POINTS; ++i) {
            float azimuth = 2.0 * PI * (float(i) + 0.5 * float(ring)) / float(BEHIND_POINTS);
            vec2 offset = float(ring) * behind.blur * vec2(cos(azimuth), sin(azimuth));
            sum += weight * behind_at(behind.pixel + offset, level);
            weights += weight;
        }
    }
    return sum / weights;
}
