// SPDX-License-Identifier: GPL-3.0-or-later
// The scene's lights, in camera space; see LightCache of core/passes/gpu_scene.h.
#include "environment.glsl"
#include "lib/constants.glsl"
#include "lib/fresnel.glsl"
#include "lib/spherical_gaussian.glsl"
#include "lib/lobe.glsl"
#include "lib/local_light.glsl"

struct LightData {
    vec4 place;      // w: radius
    vec4 axis;       // w: LIGHT_*
    vec4 intensity;
};

layout(std430, binding = 2) readonly buffer Lights { LightData lights[]; };
uniform int light_count;

// Where a lobe leaves a surface.
struct Place {
    vec3 position;
    vec3 side;  // unit normal, to where it leaves
};

// Light of the lights under a lobe about a unit direction.
vec3 local_radiance(Place place, vec3 direction, float spread) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < light_count; ++i) {
        LightData data = lights[i];
        LocalLight light =
            LocalLight(int(data.axis.w), data.place.xyz, data.place.w, data.axis.xyz, data.intensity.xyz);
        sum += light_radiance(light, place.position, direction, spread, place.side);
    }
    return sum;
}

// That of the environment and of the lights.
vec3 incoming_radiance(Place place, vec3 direction, float spread) {
    return incoming_radiance(direction, spread) + local_radiance(place, direction, spread);
}
