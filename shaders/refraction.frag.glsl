// SPDX-License-Identifier: GPL-3.0-or-later
// Shades the front faces of one group of objects: the front lobe, its way through the object to the back faces,
// and the environment behind and before. One of TRANSPORT_BUNDLE, TRANSPORT_PAPER, TRANSPORT_SINGLE,
// TRANSPORT_DEPTH_MIP, TRANSPORT_SPECULAR and one of INTERSECTION_NEWTON, INTERSECTION_MARCH is defined, and LAYERS
// where exits are searched in four layers of the geometry.
#include "environment.glsl"
#include "screen_space.glsl"
#include "lobe_tables.glsl"
#include "lib/bundle.glsl"
#include "lib/specular.glsl"
#include "lib/depth_mip.glsl"

struct Material {
    vec4 color_roughness;
    vec4 reflection_ior;
    vec4 absorption;
    ivec4 tables;  // entering, leaving, reflection (-1: none)
};
layout(std430, binding = 0) readonly buffer Materials { Material materials[]; };

uniform int tir;
uniform bool reflection;
uniform float bound;  // no ray is longer inside an object
#ifdef TRANSPORT_PAPER
uniform sampler2D pyramid_normals;
#endif
#ifdef INTERSECTION_MARCH
uniform sampler2D pyramid_depths;
#endif

layout(location = 0) out vec4 radiance;

const int AXIS_STEPS = 6;
const int RAY_STEPS = 2;

#ifdef INTERSECTION_MARCH
// Rays end at the greatest depth of all back faces (the pyramid's last level).
float march_bound(vec3 origin, vec3 d) {
    float deepest = texelFetch(pyramid_depths, ivec2(0), textureQueryLevels(pyramid_depths) - 1).y;
    return d.z < 0.0 ? min((deepest + origin.z) / -d.z, bound) : bound;
}

Exit find_exit(vec3 origin, vec3 d, Exit guess, int steps) {
    return find_exit_march(origin, d, guess, march_bound(origin, d));
}
#else
Exit find_exit(vec3 origin, vec3 d, Exit guess, int steps) { return find_exit_newton(origin, d, guess, steps, bound); }
#endif

bool has_fresnel(Material material) { return material.tables.z >= 0; }

// The lobe that enters through a front face. Beyond the critical angle of an object thinner than its surroundings,
// the front reflects all.
Lobe entering_lobe(vec3 d, vec3 n, Material material) {
    float eta = material.reflection_ior.w;
#ifdef TRANSPORT_SPECULAR
    return specular_refraction(eta, has_fresnel(material), d, n, TIR_NONE);
#else
    Lobe lobe = refracted_lobe(material.tables.x, eta, material.color_roughness.w, d, n, TIR_NONE);
#ifdef TRANSPORT_DEPTH_MIP
    lobe.direction = specular_direction(eta, d, n, TIR_NONE);
#endif
    return lobe;
#endif
}

// The lobe of a ray that leaves the object through a back face.
Lobe leaving_lobe(vec3 d, vec3 outward, float roughness, Material material) {
    float eta = 1.0 / material.reflection_ior.w;
#ifdef TRANSPORT_SPECULAR
    return specular_refraction(eta, has_fresnel(material), d, -outward, tir);
#else
    Lobe lobe = refracted_lobe(material.tables.y, eta, roughness, d, -outward, tir);
#ifdef TRANSPORT_DEPTH_MIP
    lobe.direction = specular_direction(eta, d, -outward, tir);
#endif
    return lobe;
#endif
}

Lobe mirrored_lobe(vec3 d, vec3 n, Material material) {
#ifdef TRANSPORT_SPECULAR
    return specular_reflection(material.reflection_ior.w, d, n);
#else
    return reflected_lobe(material.tables.z, material.reflection_ior.w, material.color_roughness.w, d, n);
#endif
}

vec3 transmittance(vec3 absorption, float distance_inside) { return exp(-absorption * distance_inside); }

#ifdef TRANSPORT_BUNDLE
// Four rays at the front lobe's root-mean angle, each with its own exit (method: 5.3).
vec3 transport(Material material, Lobe front, vec3 origin, vec3 n, Exit axis) {
    Moments moments = no_moments();
    vec3 weighted_color = vec3(0.0);
    for (int i = 0; i < BUNDLE_RAYS; ++i) {
        vec3 d = bundle_ray(front, n, bundle_azimuth(i));
        Exit exit = find_exit(origin, d, axis, RAY_STEPS);
        Material behind = materials[decode_material(exit.face.w)];
        vec3 outward = decode_normal(exit.face.xy);
        Lobe lobe = leaving_lobe(d, outward, behind.color_roughness.w, behind);
        moments = add_lobe(moments, lobe, outward, front.energy / float(BUNDLE_RAYS));
        weighted_color += lobe.energy * behind.color_roughness.rgb * transmittance(material.absorption.rgb, exit.t);
    }
    WideLobe lobe = wide_lobe_from_moments(moments);
    vec3 incoming = vec3(0.0);
    for (int i = 0; i < EXIT_TAPS; ++i) incoming += incoming_radiance(tap_direction(lobe, i), lobe.spread);
    return front.energy / float(BUNDLE_RAYS) * weighted_color * incoming / float(EXIT_TAPS);
}
#endif

#ifdef TRANSPORT_PAPER
const int MAX_ANISOTROPY = 8;

// Normals times coverage, and coverage, over a box of pixels: an anisotropic look-up in the pyramid, spelled out
// since OpenGL 4.5 need not filter anisotropically.
vec4 filtered_normals(vec2 low, vec2 high) {
    vec2 extent = max(high - low, vec2(1.0));
    bool wide = extent.x > extent.y;
    float narrow_side = max(min(extent.x, extent.y), max(extent.x, extent.y) / float(MAX_ANISOTROPY));
    int taps = int(ceil(max(extent.x, extent.y) / narrow_side));
    float lod = log2(narrow_side);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < taps; ++i) {
        float along = (float(i) + 0.5) / float(taps) - 0.5;
        vec2 pixel = 0.5 * (low + high) + along * (wide ? vec2(extent.x, 0.0) : vec2(0.0, extent.y));
        sum += textureLod(pyramid_normals, pixel / frame_size, lod);
    }
    return sum / float(taps);
}

// Bounding box of the exits of four rays that hold 75 % of the lobe, the normals in it as a distribution, and the
// back lobe for both roughnesses at once (de Rousiers et al. 2012, section 4.3).
vec3 transport(Material material, Lobe front, vec3 origin, vec3 n, Exit axis) {
    Lobe bounding = front;
    bounding.spread = clamp(-log(0.25) / kappa_from_spread(front.spread), LOBE_MIN_SPREAD, 1.0);  // 1 - cos theta_b
    vec2 center = pixel_of(origin + axis.t * front.direction);
    vec2 low = center;
    vec2 high = center;
    for (int i = 0; i < BUNDLE_RAYS; ++i) {
        vec3 d = bundle_ray(bounding, n, bundle_azimuth(i));
        Exit exit = find_exit(origin, d, axis, RAY_STEPS);
        vec2 pixel = pixel_of(origin + exit.t * d);
        low = min(low, pixel);
        high = max(high, pixel);
    }
    vec4 normals = filtered_normals(low, high);
    Material behind = materials[decode_material(axis.face.w)];
    float mean_length = clamp(length(normals.xyz) / max(normals.w, 1e-6), 0.0, 1.0 - LOBE_MIN_SPREAD);
    vec3 outward = normals.w > 0.0 && mean_length > 0.0 ? normalize(normals.xyz) : decode_normal(axis.face.xy);
    float kappa_G = kappa_from_spread(1.0 - mean_length);
    float alpha = max(alpha_from_roughness(behind.color_roughness.w), 1e-4);
    float kappa_D = 2.0 / (alpha * alpha);
    float kappa = kappa_G * kappa_D / (kappa_G + kappa_D);
    float roughness = min(pow(2.0 / kappa, 0.25), 1.0);
    Lobe lobe = leaving_lobe(front.direction, outward, roughness, behind);
    return front.energy * lobe.energy * behind.color_roughness.rgb * transmittance(material.absorption.rgb, axis.t) *
           incoming_radiance(lobe.direction, lobe.spread);
}
#endif

#if defined(TRANSPORT_SINGLE) || defined(TRANSPORT_SPECULAR) || defined(TRANSPORT_DEPTH_MIP)
// The ray along the front lobe's axis, and the back lobe alone.
vec3 transport(Material material, Lobe front, vec3 origin, vec3 n, Exit axis) {
    Material behind = materials[decode_material(axis.face.w)];
    Lobe lobe = leaving_lobe(front.direction, decode_normal(axis.face.xy), behind.color_roughness.w, behind);
#ifdef TRANSPORT_DEPTH_MIP
    Lobe straight_front = entering_lobe(-n, n, material);
    Lobe straight_back = leaving_lobe(-n, -n, behind.color_roughness.w, behind);
    lobe.spread = depth_mip_spread(straight_front.spread, straight_back.spread, axis.t, bound);
#endif
    vec3 color = behind.color_roughness.rgb * transmittance(material.absorption.rgb, axis.t);
    return front.energy * lobe.energy * color * incoming_radiance(lobe.direction, lobe.spread);
}
#endif

// Interpolated normals may face away at silhouettes; such a normal is bent until it is seen edge-on.
vec3 toward_viewer(vec3 n, vec3 d) { return normalize(n - max(dot(n, d) + 1e-3, 0.0) * d); }

void main() {
    vec4 face = texelFetch(front_faces, ivec2(gl_FragCoord.xy), 0);
    if (face.w < 0.0 || decode_group(face.w) != group) discard;
    Material material = materials[decode_material(face.w)];
    vec3 origin = position_at(gl_FragCoord.xy, face.z);
    vec3 d = view_direction(origin);
    vec3 n = toward_viewer(decode_normal(face.xy), d);

    Lobe front = entering_lobe(d, n, material);
    vec4 behind = first_back_face(ivec2(gl_FragCoord.xy));
    vec3 sum;
    if (behind.w < 0.0) {
        // An open surface without a back: light never leaves the glass again.
        sum = front.energy * incoming_radiance(front.direction, front.spread);
    } else {
        float thickness = max(behind.z - face.z, 0.0) / max(-front.direction.z, 0.1);
        Exit guess = Exit(min(thickness, bound), behind);
        Exit axis = find_exit(origin, front.direction, guess, AXIS_STEPS);
        sum = transport(material, front, origin, n, axis);
    }
    sum *= material.color_roughness.rgb;
    if (reflection && has_fresnel(material)) {
        Lobe mirror = mirrored_lobe(d, n, material);
        sum += mirror.energy * material.reflection_ior.rgb * incoming_radiance(mirror.direction, mirror.spread);
    }
    radiance = vec4(sum, 1.0);
}
