// SPDX-License-Identifier: GPL-3.0-or-later
// Shades the front faces of one group of objects: the front lobe, its way through the object to the back faces,
// and the environment behind and before. One of TRANSPORT_BUNDLE, TRANSPORT_PAPER, TRANSPORT_SINGLE,
// TRANSPORT_DEPTH_MIP, TRANSPORT_SPECULAR and one of INTERSECTION_NEWTON, INTERSECTION_MARCH is defined, LAYERS where
// exits are searched in four layers of the geometry, BOUNCE where rays are followed after they are reflected inside
// (bounce.glsl), FRONT_ROUGHNESS where textures make roughness vary, and CLASSES
// and CLASS_LAYERS (coverage.glsl) where its classes on the back count.
#include "local_lights.glsl"
#include "screen_space.glsl"
#include "lobes.glsl"
#include "coverage.glsl"
#include "lib/bundle.glsl"
#include "lib/specular.glsl"
#include "lib/depth_mip.glsl"

#ifdef FRONT_ROUGHNESS
uniform sampler2D front_roughness;
#endif

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
Lobe entering_lobe(vec3 d, vec3 n, float roughness, Material material) {
    float eta = material.reflection_ior.w;
#ifdef TRANSPORT_SPECULAR
    return specular_refraction(eta, has_fresnel(material), d, n, TIR_NONE);
#else
    Lobe lobe = refracted_lobe(material.tables.x, eta, roughness, d, n, TIR_NONE);
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

Lobe mirrored_lobe(vec3 d, vec3 n, float roughness, Material material) {
#ifdef TRANSPORT_SPECULAR
    return specular_reflection(material.reflection_ior.w, d, n);
#else
    return reflected_lobe(material.tables.z, material.reflection_ior.w, roughness, d, n);
#endif
}

// Where the lobes that are looked up leave: all of a pixel's refracted ones at the exit of its axis.
Place place = Place(vec3(0.0), vec3(0.0));

bool has_tail(Material material) { return material.absorption.w > 0.0; }

// Under a lobe and, where it has one, its tail.
vec3 incoming_radiance(Lobe lobe, bool tail) {
    if (!tail) return incoming_radiance(place, lobe.direction, lobe.spread);
    return mix(incoming_radiance(place, lobe.direction, widened_spread(lobe.spread, CORE_WIDTH)),
               incoming_radiance(place, lobe.direction, widened_spread(lobe.spread, TAIL_WIDTH)), TAIL_SHARE);
}

vec3 transmittance(vec3 absorption, float distance_inside) { return exp(-absorption * distance_inside); }

// Of the front face at a pixel.
float roughness_at(ivec2 pixel, Material material) {
#ifdef FRONT_ROUGHNESS
    return MAX_ROUGHNESS * texelFetch(front_roughness, pixel, 0).x;
#else
    return material.color_roughness.w;
#endif
}

#ifdef TRANSPORT_BUNDLE
#include "bounce.glsl"

// Four rays at the front lobe's root-mean angle, each with its own exit (method: 5.3).
#ifdef CLASS_LAYERS
// Of the distance from the exit of the axis, which a ray's part of the footprint measures: the kernel of a look-up in
// the pyramid has half a texel's standard deviation, so that four of these make a footprint without gaps.
const float FOOTPRINT_SHARE = 0.7;

// What leaves at all exits, in the mean over rays, and by class of roughness, four a layer.
struct ClassSums {
    vec4 energies[CLASS_LAYERS];
    mat4x3 vectors[CLASS_LAYERS];  // of directions, times energy
    vec4 variances[CLASS_LAYERS];  // of the roughness, alpha^2, times energy
    float energy;
    vec3 color;     // times energy
    float table_x;  // of the lobe tables, times energy
};

ClassSums no_class_sums() {
    ClassSums sums;
    for (int layer = 0; layer < CLASS_LAYERS; ++layer) {
        sums.energies[layer] = vec4(0.0);
        sums.vectors[layer] = mat4x3(0.0);
        sums.variances[layer] = vec4(0.0);
    }
    sums.energy = 0.0;
    sums.color = vec3(0.0);
    sums.table_x = 0.0;
    return sums;
}

// Adds a lobe of an interface's mean roughness, with the ratios of its material's classes there.
ClassSums add_ray(ClassSums sums, Lobe lobe, float table_x, vec3 color, Coverage coverage, Material material) {
    float energy = lobe.energy / float(BUNDLE_RAYS);
    for (int layer = 0; layer < CLASS_LAYERS; ++layer) {
        vec4 energies = energy * coverage.ratios[layer];
        vec4 roughness = roughness_of_classes(material, layer);
        vec4 alpha = roughness * roughness;
        sums.energies[layer] += energies;
        sums.vectors[layer] += outerProduct(lobe.direction, energies);
        sums.variances[layer] += energies * alpha * alpha;
    }
    sums.energy += energy;
    sums.color += energy * color;
    sums.table_x += energy * table_x;
    return sums;
}

// A class of lobes of one spread.
vec3 incoming_radiance(float energy, vec3 vector, float spread) {
    Lobe lobe = lobe_from_moments(Moments(energy, (1.0 - spread) * vector, mat3(0.0)));
    return incoming_radiance(place, lobe.direction, lobe.spread);
}

// Each class with the spread that its lobe has in the mean of the angles of incidence. behind: of the exits.
vec3 radiance_of(ClassSums sums, Material behind) {
    float eta = 1.0 / behind.reflection_ior.w;
    float cos_theta = lobe_table_cosine(sums.table_x / max(sums.energy, 1e-12), eta);
    vec3 sum = vec3(0.0);
    for (int c = 0; c < CLASSES; ++c) {
        float energy = sums.energies[c / 4][c % 4];
        if (energy <= 0.0) continue;
        float roughness = sqrt(sqrt(sums.variances[c / 4][c % 4] / energy));
        float spread = planar_lobe(behind.tables.y, cos_theta, eta, roughness).spread;
        vec3 vector = sums.vectors[c / 4][c % 4];
        bool tail = has_tail(behind);
        vec3 incoming = incoming_radiance(energy, vector, tail ? widened_spread(spread, CORE_WIDTH) : spread);
        if (tail)
            incoming = mix(incoming, incoming_radiance(energy, vector, widened_spread(spread, TAIL_WIDTH)), TAIL_SHARE);
        sum += energy * incoming;
    }
    return sums.color / max(sums.energy, 1e-12) * sum;
}

// With the coverage ratios of each ray's own part of the footprint (method: 7). Energy and direction of a ray's lobe,
// which change little with roughness, are those of its mean roughness.
vec3 transport(Material material, Lobe front, vec3 origin, vec3 n, Exit axis) {
    vec2 center = pixel_of(origin + axis.t * front.direction);
    ClassSums sums = no_class_sums();
    Arrival arrivals[BUNDLE_RAYS];
    for (int i = 0; i < BUNDLE_RAYS; ++i) {
        vec3 d = bundle_ray(front, n, bundle_azimuth(i));
        Exit exit = find_exit(origin, d, axis, RAY_STEPS);
        Material behind = materials[decode_material(exit.face.w)];
        vec3 outward = decode_normal(exit.face.xy);
        vec2 pixel = pixel_of(origin + exit.t * d);
        Coverage coverage = coverage_about(pixel, exit.face, FOOTPRINT_SHARE * distance(pixel, center));
        float roughness = mean_roughness(coverage, behind);
        Lobe lobe = leaving_lobe(d, outward, roughness, behind);
        float eta = 1.0 / behind.reflection_ior.w;
        float table_x = lobe_table_x(refracted_cosine(eta, d, -outward, tir), eta);
        vec3 throughput = transmittance(material.absorption.rgb, exit.t);
        sums = add_ray(sums, lobe, table_x, behind.color_roughness.rgb * throughput, coverage, behind);
        arrivals[i] = Arrival(origin + exit.t * d, d, exit.face, roughness, throughput, 0.0);
    }
    vec3 refracted = radiance_of(sums, materials[decode_material(axis.face.w)]);
    return front.energy * (refracted + reflected_light(arrivals, material));
}
#else
vec3 incoming_radiance(WideLobe lobe) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < EXIT_TAPS; ++i) sum += incoming_radiance(place, tap_direction(lobe, i), lobe.spread);
    return sum / float(EXIT_TAPS);
}

Moments add_widened(Moments moments, Lobe lobe, float width, vec3 outward, float weight) {
    lobe.spread = widened_spread(lobe.spread, width);
    return add_lobe(moments, lobe, outward, weight);
}

vec3 transport(Material material, Lobe front, vec3 origin, vec3 n, Exit axis) {
    bool tail = has_tail(materials[decode_material(axis.face.w)]);
    Moments moments = no_moments();
    Moments tails = no_moments();
    vec3 weighted_color = vec3(0.0);
    Arrival arrivals[BUNDLE_RAYS];
    for (int i = 0; i < BUNDLE_RAYS; ++i) {
        vec3 d = bundle_ray(front, n, bundle_azimuth(i));
        Exit exit = find_exit(origin, d, axis, RAY_STEPS);
        Material behind = materials[decode_material(exit.face.w)];
        vec3 outward = decode_normal(exit.face.xy);
        Lobe lobe = leaving_lobe(d, outward, behind.color_roughness.w, behind);
        moments = add_widened(moments, lobe, tail ? CORE_WIDTH : 1.0, outward, front.energy / float(BUNDLE_RAYS));
        if (tail) tails = add_widened(tails, lobe, TAIL_WIDTH, outward, front.energy / float(BUNDLE_RAYS));
        vec3 throughput = transmittance(material.absorption.rgb, exit.t);
        weighted_color += lobe.energy * behind.color_roughness.rgb * throughput;
        arrivals[i] = Arrival(origin + exit.t * d, d, exit.face, behind.color_roughness.w, throughput, 0.0);
    }
    vec3 incoming = incoming_radiance(wide_lobe_from_moments(moments));
    if (tail) incoming = mix(incoming, incoming_radiance(wide_lobe_from_moments(tails)), TAIL_SHARE);
    vec3 refracted = weighted_color / float(BUNDLE_RAYS) * incoming;
    return front.energy * (refracted + reflected_light(arrivals, material));
}
#endif
#endif

#ifdef TRANSPORT_PAPER
const int MAX_ANISOTROPY = 8;

// A box of pixels as squares in a row: an anisotropic look-up in a pyramid, spelled out since OpenGL 4.5 need not
// filter anisotropically.
struct Box {
    int taps;
    vec2 center;
    vec2 extent;  // along the row
    float level;
};

Box box_between(vec2 low, vec2 high) {
    vec2 extent = max(high - low, vec2(1.0));
    bool wide = extent.x > extent.y;
    float narrow_side = max(min(extent.x, extent.y), max(extent.x, extent.y) / float(MAX_ANISOTROPY));
    int taps = int(ceil(max(extent.x, extent.y) / narrow_side));
    return Box(taps, 0.5 * (low + high), wide ? vec2(extent.x, 0.0) : vec2(0.0, extent.y), log2(narrow_side));
}

// Pixel of a tap.
vec2 tap_of(Box box, int i) { return box.center + ((float(i) + 0.5) / float(box.taps) - 0.5) * box.extent; }

// Normals times coverage, and coverage, over a box.
vec4 filtered_normals(Box box) {
    vec4 sum = vec4(0.0);
    for (int i = 0; i < box.taps; ++i) sum += textureLod(pyramid_normals, tap_of(box, i) / frame_size, box.level);
    return sum / float(box.taps);
}

// Over a box about an exit.
Coverage filtered_coverage(Box box, vec4 face) {
#ifdef CLASS_LAYERS
    Coverage shares;
    for (int layer = 0; layer < CLASS_LAYERS; ++layer) {
        shares.ratios[layer] = vec4(0.0);
        for (int i = 0; i < box.taps; ++i)
            shares.ratios[layer] += sample_classes(layer, tap_of(box, i), face, box.level);
    }
    return normalized_coverage(shares);
#else
    return coverage_about(box.center, face, 1.0);
#endif
}

// Bounding box of the exits of four rays that hold 75 % of the lobe, the normals in it as a distribution, and the
// back lobe for both roughnesses at once (de Rousiers et al. 2012, section 4.3), for each class of the roughness of the
// back (section 5.1).
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
    Box box = box_between(low, high);
    vec4 normals = filtered_normals(box);
    Material behind = materials[decode_material(axis.face.w)];
    float mean_length = clamp(length(normals.xyz) / max(normals.w, 1e-6), 0.0, 1.0 - LOBE_MIN_SPREAD);
    vec3 outward = normals.w > 0.0 && mean_length > 0.0 ? normalize(normals.xyz) : decode_normal(axis.face.xy);
    float kappa_G = kappa_from_spread(1.0 - mean_length);
    Coverage coverage = filtered_coverage(box, axis.face);
    vec3 sum = vec3(0.0);
    for (int c = 0; c < CLASSES; ++c) {
        float ratio = ratio_of_class(coverage, c);
        if (ratio <= 0.0) continue;
        float alpha = max(alpha_from_roughness(roughness_of_class(behind, c)), 1e-4);
        float kappa_D = 2.0 / (alpha * alpha);
        float kappa = kappa_G * kappa_D / (kappa_G + kappa_D);
        float roughness = min(pow(2.0 / kappa, 0.25), 1.0);
        Lobe lobe = leaving_lobe(front.direction, outward, roughness, behind);
        sum += ratio * lobe.energy * incoming_radiance(place, lobe.direction, lobe.spread);
    }
    return front.energy * behind.color_roughness.rgb * transmittance(material.absorption.rgb, axis.t) * sum;
}
#endif

#if defined(TRANSPORT_SINGLE) || defined(TRANSPORT_SPECULAR) || defined(TRANSPORT_DEPTH_MIP)
// The ray along the front lobe's axis, and the back lobe alone.
vec3 transport(Material material, Lobe front, vec3 origin, vec3 n, Exit axis) {
    Material behind = materials[decode_material(axis.face.w)];
    vec3 outward = decode_normal(axis.face.xy);
    vec2 pixel = pixel_of(origin + axis.t * front.direction);
    // The footprint of the whole lobe, as wide as where its rays are at the axis' distance.
    vec2 beside = pixel_of(origin + axis.t * bundle_ray(front, n, bundle_azimuth(0)));
    Coverage coverage = coverage_about(pixel, axis.face, sqrt(2.0) * distance(pixel, beside));
    vec3 sum = vec3(0.0);
    for (int c = 0; c < CLASSES; ++c) {
        float ratio = ratio_of_class(coverage, c);
        if (ratio <= 0.0) continue;
        Lobe lobe = leaving_lobe(front.direction, outward, roughness_of_class(behind, c), behind);
#ifdef TRANSPORT_DEPTH_MIP
        Lobe straight_front = entering_lobe(-n, n, material.color_roughness.w, material);
        Lobe straight_back = leaving_lobe(-n, -n, roughness_of_class(behind, c), behind);
        lobe.spread = depth_mip_spread(straight_front.spread, straight_back.spread, axis.t, bound);
#endif
        sum += ratio * lobe.energy * incoming_radiance(place, lobe.direction, lobe.spread);
    }
    return front.energy * behind.color_roughness.rgb * transmittance(material.absorption.rgb, axis.t) * sum;
}
#endif

void main() {
    vec4 face = texelFetch(front_faces, ivec2(gl_FragCoord.xy), 0);
    if (face.w < 0.0 || decode_group(face.w) != group) discard;
    Material material = materials[decode_material(face.w)];
    if (material.absorption.w < 0.0) discard;  // thin_layers.frag.glsl shades it
    vec3 origin = position_at(gl_FragCoord.xy, face.z);
    vec3 d = view_direction(origin);
    vec3 n = toward_viewer(decode_normal(face.xy), d);

    float roughness = roughness_at(ivec2(gl_FragCoord.xy), material);
    Lobe front = entering_lobe(d, n, roughness, material);
    vec4 behind = first_back_face(ivec2(gl_FragCoord.xy));
    vec3 sum;
    if (behind.w < 0.0) {
        // An open surface without a back: light never leaves the glass again.
        place = Place(origin, -n);
        sum = front.energy * incoming_radiance(place, front.direction, front.spread);
    } else {
        float thickness = max(behind.z - face.z, 0.0) / max(-front.direction.z, 0.1);
        Exit guess = Exit(min(thickness, bound), behind);
        Exit axis = find_exit(origin, front.direction, guess, AXIS_STEPS);
        place = Place(origin + axis.t * front.direction, decode_normal(axis.face.xy));
        sum = transport(material, front, origin, n, axis);
    }
    sum *= material.color_roughness.rgb;
    if (reflection && has_fresnel(material)) {
        Lobe mirror = mirrored_lobe(d, n, roughness, material);
        place = Place(origin, n);
        sum += mirror.energy * material.reflection_ior.rgb * incoming_radiance(mirror, has_tail(material));
    }
    radiance = vec4(sum, 1.0);
}
