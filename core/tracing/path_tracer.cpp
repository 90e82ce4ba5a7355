// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/path_tracer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/error.h"
#include "core/material/microfacet.h"
#include "core/math/pixel_filter.h"
#include "core/tracing/environment_light.h"
#include "core/tracing/random.h"
#include "core/tracing/ray_scene.h"

namespace verglas {
namespace {

// Sharper distributions than this are beyond float; such glass is as good as clear.
constexpr float min_alpha = 1e-4F;

// Rotation into the frame whose Z axis is n (Duff et al. 2017).
glm::mat3 frame_of(const glm::vec3& n) {
    const float sign = std::copysign(1.0F, n.z);
    const float a = -1.0F / (sign + n.z);
    const float b = n.x * n.y * a;
    return {glm::vec3(1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x),
            glm::vec3(b, sign + n.y * n.y * a, -n.y), n};
}

// Power heuristic of two strategies with one sample each (Veach 1997).
float mis_weight(float pdf, float other) {
    const float p = pdf * pdf;
    const float q = other * other;
    return p + q > 0.0F ? p / (p + q) : 0.0F;
}

// A point beside the surface on the side that a ray leaves to, far enough that it does not meet it again.
glm::vec3 beside(const Hit& hit, const glm::vec3& d) {
    const glm::vec3& p = hit.position;
    const float scale = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z), hit.t, 1e-3F});
    return p +
           (glm::dot(d, hit.geometric_normal) > 0.0F ? 1.0F : -1.0F) * 4e-6F * scale * hit.geometric_normal;
}

class PathTracer {
  public:
    PathTracer(const Scene& scene, const PathSettings& settings)
        : scene_(scene), settings_(settings), rays_(scene), light_(scene) {}

    struct Ray {
        glm::vec3 origin;
        glm::vec3 d;
    };
    Ray camera_ray(glm::vec2 pixel) const;
    glm::vec4 trace(Ray ray, Random& random) const;
    glm::vec4 normal_depth(const Ray& ray) const;

  private:
    glm::vec3 direct_light(const Hit& hit, const glm::mat3& frame, const RoughInterface& surface,
                           const glm::vec3& o, const Material& material, bool entering, Random& random) const;

    const Scene& scene_;
    const PathSettings& settings_;
    RayScene rays_;
    EnvironmentLight light_;
    glm::mat4 clip_to_world_ = glm::inverse(scene_.camera.projection * scene_.camera.view);
};

PathTracer::Ray PathTracer::camera_ray(glm::vec2 pixel) const {
    const glm::vec2 ndc = 2.0F * pixel / glm::vec2(settings_.size) - 1.0F;
    const glm::vec4 near = clip_to_world_ * glm::vec4(ndc, -1.0F, 1.0F);
    const glm::vec4 far = clip_to_world_ * glm::vec4(ndc, 1.0F, 1.0F);
    const glm::vec3 origin = glm::vec3(near) / near.w;
    return {origin, glm::normalize(glm::vec3(far) / far.w - origin)};
}

glm::vec4 PathTracer::normal_depth(const Ray& ray) const {
    const auto hit = rays_.intersect(ray.origin, ray.d);
    if (!hit) return {0.0F, 0.0F, 0.0F, 1e10F};
    return {hit->normal, -(scene_.camera.view * glm::vec4(hit->position, 1.0F)).z};
}

// Light of the environment that this interface sends toward o, by directions drawn from the environment.
glm::vec3 PathTracer::direct_light(const Hit& hit, const glm::mat3& frame, const RoughInterface& surface,
                                   const glm::vec3& o, const Material& material, bool entering,
                                   Random& random) const {
    const EnvironmentLight::Sample light = light_.sample(random.uniform2());
    if (light.pdf <= 0.0F) return glm::vec3(0.0F);
    // Light comes from outside: to a path that is outside by reflection, to one that is inside by refraction.
    if (glm::dot(light.direction, hit.geometric_normal) <= 0.0F) return glm::vec3(0.0F);
    const glm::vec3 i = glm::transpose(frame) * light.direction;
    if ((i.z > 0.0F) != entering) return glm::vec3(0.0F);
    const RoughInterface::Value value = surface.evaluate(o, i);
    if (value.f_cos <= 0.0F || !rays_.escapes(beside(hit, light.direction), light.direction))
        return glm::vec3(0.0F);
    const glm::vec3 color = i.z > 0.0F ? material.reflection_color : material.color;
    return color * (value.f_cos / light.pdf * mis_weight(light.pdf, value.pdf)) *
           light_.radiance(light.direction);
}

glm::vec4 PathTracer::trace(Ray ray, Random& random) const {
    const bool two_interface = settings_.mode == PathMode::TwoInterface;
    glm::vec3 sum(0.0F);
    glm::vec3 throughput(1.0F);
    float pdf = 0.0F;  // of the ray's direction; 0 for the camera's
    for (int depth = 0; depth <= settings_.max_interfaces; ++depth) {
        const bool beyond = two_interface && depth == 2;
        const auto hit = beyond ? std::nullopt : rays_.intersect(ray.origin, ray.d);
        if (!hit) {
            if (depth == 0 && settings_.transparent) return glm::vec4(0.0F);
            const float weight = pdf > 0.0F ? mis_weight(pdf, light_.pdf(ray.d)) : 1.0F;
            sum += throughput * weight * light_.radiance(ray.d);
            break;
        }
        const Material& material = scene_.materials[hit->material];
        const bool entering = glm::dot(ray.d, hit->geometric_normal) < 0.0F;
        if (!entering) throughput *= glm::exp(-material.absorption * hit->t);
        glm::vec3 n = entering ? hit->normal : -hit->normal;
        // Interpolated normals may face away at silhouettes; they are bent as in refraction.frag.glsl.
        n = glm::normalize(n - std::max(glm::dot(n, ray.d) + 1e-3F, 0.0F) * ray.d);
        const glm::mat3 frame = frame_of(n);
        const glm::vec3 o = glm::transpose(frame) * -ray.d;
        const float alpha = std::max(model::alpha_from_roughness(material.roughness), min_alpha);
        const float ior = std::clamp(material.ior, 1.0F / max_eta, max_eta);
        const RoughInterface surface(material.ndf, alpha, entering ? ior : 1.0F / ior, material.fresnel,
                                     !two_interface);
        // In two_interface, only what leaves sees light, and straight: no strategy beside the lobe's is
        // needed.
        if (!two_interface)
            sum += throughput * direct_light(*hit, frame, surface, o, material, entering, random);
        const glm::vec2 u = random.uniform2();
        const auto sample = surface.sample(o, u, random.uniform());
        if (!sample) break;
        const glm::vec3 d = frame * sample->direction;
        const bool refracted = sample->direction.z < 0.0F;
        // The side of the interpolated normal must be the triangle's.
        if ((glm::dot(d, hit->geometric_normal) > 0.0F) != (refracted != entering)) break;
        throughput *= sample->weight * (refracted ? material.color : material.reflection_color);
        pdf = two_interface ? 0.0F : sample->pdf;
        ray = {beside(*hit, d), d};
    }
    return {sum, 1.0F};
}

}  // namespace

std::optional<Frame> trace_paths(const Scene& scene, const PathSettings& settings,
                                 const std::function<bool(int, int)>& progress) {
    using Clock = std::chrono::steady_clock;
    if (settings.size.x < 1 || settings.size.y < 1) throw Error("A picture needs at least one pixel.");
    if (settings.samples < 1) throw Error("A picture needs at least one sample.");
    const PathTracer tracer(scene, settings);
    Frame frame;
    frame.size = settings.size;
    frame.combined.assign(std::size_t(settings.size.x) * settings.size.y, glm::vec4(0.0F));
    frame.normal_depth.resize(frame.combined.size());
    const Clock::time_point begin = Clock::now();
    for (int sample = 0; sample < settings.samples; ++sample) {
        tbb::parallel_for(0, settings.size.y, [&](int y) {
            for (int x = 0; x < settings.size.x; ++x) {
                const std::size_t pixel = std::size_t(y) * settings.size.x + x;
                Random random(pixel, static_cast<std::uint64_t>(sample), settings.seed);
                const glm::vec2 center(x + 0.5F, y + 0.5F);
                const glm::vec2 offset = blackman_harris_offset(random.uniform2(), settings.filter_width);
                frame.combined[pixel] += tracer.trace(tracer.camera_ray(center + offset), random);
                if (sample == 0) frame.normal_depth[pixel] = tracer.normal_depth(tracer.camera_ray(center));
            }
        });
        if (progress && !progress(sample + 1, settings.samples)) return std::nullopt;
    }
    for (glm::vec4& pixel : frame.combined) pixel /= static_cast<float>(settings.samples);
    frame.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    return frame;
}

}  // namespace verglas
