// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/path_tracer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/material/microfacet.h"
#include "core/math/pixel_filter.h"
#include "core/math/sobol.h"
#include "core/tracing/crossing.h"
#include "core/tracing/environment_light.h"
#include "core/tracing/media.h"
#include "core/tracing/ray_scene.h"

namespace verglas {
namespace {

// Sharper distributions than this are beyond float; such glass is as good as clear.
constexpr float min_alpha = 1e-4F;

// Coordinates of a sample's Sobol point: the pixel filter's, then those of each interface.
constexpr int filter_dimension = 0;
constexpr int first_interface_dimension = 2;
constexpr int interface_dimensions = 5;
constexpr int facet_dimension = 0;
constexpr int light_dimension = 2;
constexpr int choice_dimension = 4;

// Surfaces that don't bend a ray, one behind the other; rounding must not keep it at one for ever.
constexpr int max_passed = 1000;

// Paths between two calls of progress.
constexpr int block_paths = 1 << 15;

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

// An interface as a path meets it.
struct Crossing {
    const Hit& hit;
    const Material& material;
    bool entering;
    glm::mat3 frame;
    glm::vec3 o;  // toward the viewer, in the frame
    RoughInterface surface;
};

// Whether there may be surfaces that light goes through unbent.
bool has_straight_surfaces(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& material) {
        return material.priority > 0 || std::abs(material.ior - 1.0F) < MediumStack::min_index_step;
    });
}

}  // namespace

class PathTracer::Paths {
  public:
    Paths(const Scene& scene, const PathSettings& settings)
        : scene_(scene),
          settings_(settings),
          rays_(scene),
          light_(scene),
          has_straight_surfaces_(has_straight_surfaces(scene)) {}

    Ray camera_ray(glm::vec2 pixel) const;
    glm::vec4 trace(Ray ray, const SobolPoint& point) const;
    glm::vec4 normal_depth(const Ray& ray) const;

  private:
    bool two_interface() const { return settings_.mode == PathMode::TwoInterface; }
    Reflected reflected(const Material& material) const;
    std::optional<Hit> next_interface(Ray& ray, MediumStack& media, glm::vec3& throughput) const;
    glm::vec3 escape(Ray ray, MediumStack media) const;
    Crossing cross(const Hit& hit, const glm::vec3& d, const MediumStack& media) const;
    glm::vec3 direct_light(const Crossing& crossing, MediumStack media, glm::vec2 u) const;

    const Scene& scene_;
    const PathSettings& settings_;
    RayScene rays_;
    EnvironmentLight light_;
    bool has_straight_surfaces_;
    glm::mat4 clip_to_world_ = glm::inverse(scene_.camera.projection * scene_.camera.view);
};

Ray PathTracer::Paths::camera_ray(glm::vec2 pixel) const {
    const glm::vec2 ndc = 2.0F * pixel / glm::vec2(settings_.size) - 1.0F;
    const glm::vec4 near = clip_to_world_ * glm::vec4(ndc, -1.0F, 1.0F);
    const glm::vec4 far = clip_to_world_ * glm::vec4(ndc, 1.0F, 1.0F);
    const glm::vec3 origin = glm::vec3(near) / near.w;
    return {origin, glm::normalize(glm::vec3(far) / far.w - origin)};
}

glm::vec4 PathTracer::Paths::normal_depth(const Ray& ray) const {
    const auto hit = rays_.intersect(ray.origin, ray.d);
    if (!hit) return {0.0F, 0.0F, 0.0F, 1e10F};
    return {hit->normal, -(scene_.camera.view * glm::vec4(hit->position, 1.0F)).z};
}

// Blender's Refraction BSDF, without Fresnel, has no reflection.
Reflected PathTracer::Paths::reflected(const Material& material) const {
    if (two_interface()) return settings_.tir ? Reflected::Total : Reflected::None;
    return material.fresnel ? Reflected::All : Reflected::None;
}

// Takes a ray to the next surface that bends light, through those that don't; throughput: what is left of it
// there. None where the ray escapes.
std::optional<Hit> PathTracer::Paths::next_interface(Ray& ray, MediumStack& media,
                                                     glm::vec3& throughput) const {
    for (int passed = 0; passed <= max_passed; ++passed) {
        auto hit = rays_.intersect(ray.origin, ray.d);
        if (!hit) return hit;
        const bool entering = is_entering(*hit, ray.d);
        throughput *= media.transmittance(scene_, *hit, entering);
        const MediumStack::Interface interface = media.interface(scene_, *hit, entering);
        if (interface.bends()) return hit;
        if (interface.is_real) throughput *= scene_.materials[hit->material].color;
        media.cross(*hit, entering);
        ray.origin = beside(*hit, ray.d);
    }
    throughput = glm::vec3(0.0F);
    return std::nullopt;
}

// The share of light that comes along a ray from the environment, unbent.
glm::vec3 PathTracer::Paths::escape(Ray ray, MediumStack media) const {
    if (!has_straight_surfaces_) return glm::vec3(rays_.escapes(ray.origin, ray.d) ? 1.0F : 0.0F);
    glm::vec3 share(1.0F);
    return next_interface(ray, media, share) ? glm::vec3(0.0F) : share;
}

Crossing PathTracer::Paths::cross(const Hit& hit, const glm::vec3& d, const MediumStack& media) const {
    const Material& material = scene_.materials[hit.material];
    const bool entering = is_entering(hit, d);
    const glm::mat3 frame = frame_of(facing_normal(hit, d));
    const float alpha = std::max(model::alpha_from_roughness(roughness_at(material, hit)), min_alpha);
    const RoughInterface surface(material.ndf, alpha, media.interface(scene_, hit, entering).eta,
                                 material.fresnel, reflected(material));
    return {hit, material, entering, frame, glm::transpose(frame) * -d, surface};
}

// Light of the environment that an interface sends toward o, by directions drawn from the environment. media:
// those on the side of o.
glm::vec3 PathTracer::Paths::direct_light(const Crossing& crossing, MediumStack media, glm::vec2 u) const {
    const Hit& hit = crossing.hit;
    const EnvironmentLight::Sample light = light_.sample(u);
    if (light.pdf <= 0.0F) return glm::vec3(0.0F);
    // Light comes from outside: to a path that is outside by reflection, to one that is inside by refraction.
    if (glm::dot(light.direction, hit.geometric_normal) <= 0.0F) return glm::vec3(0.0F);
    const glm::vec3 i = glm::transpose(crossing.frame) * light.direction;
    if ((i.z > 0.0F) != crossing.entering) return glm::vec3(0.0F);
    const RoughInterface::Value value = crossing.surface.evaluate(crossing.o, i);
    if (value.f_cos <= 0.0F) return glm::vec3(0.0F);
    if (i.z < 0.0F) media.cross(hit, crossing.entering);
    const glm::vec3 visible =
        two_interface() ? glm::vec3(1.0F) : escape({beside(hit, light.direction), light.direction}, media);
    const glm::vec3 color = i.z > 0.0F ? crossing.material.reflection_color : crossing.material.color;
    return visible * color * (value.f_cos / light.pdf * mis_weight(light.pdf, value.pdf)) *
           light_.radiance(light.direction);
}

glm::vec4 PathTracer::Paths::trace(Ray ray, const SobolPoint& point) const {
    glm::vec3 sum(0.0F);
    glm::vec3 throughput(1.0F);
    const glm::vec3 eye = ray.origin;
    MediumStack media;
    float pdf = 0.0F;  // of the ray's direction; 0 where direct_light() has no part in it
    bool left = false;
    for (int depth = 0; depth <= settings_.max_interfaces; ++depth) {
        const auto hit = two_interface() && left ? std::nullopt : next_interface(ray, media, throughput);
        if (!hit) {
            if (ray.origin == eye && settings_.transparent) return glm::vec4(0.0F);
            const float weight = pdf > 0.0F ? mis_weight(pdf, light_.pdf(ray.d)) : 1.0F;
            sum += throughput * weight * light_.radiance(ray.d);
            break;
        }
        const Crossing crossing = cross(*hit, ray.d, media);
        const int dimension = first_interface_dimension + depth * interface_dimensions;
        const bool lit = !(two_interface() && crossing.entering);
        if (lit) sum += throughput * direct_light(crossing, media, point.pair(dimension + light_dimension));
        const auto sample = crossing.surface.sample(crossing.o, point.pair(dimension + facet_dimension),
                                                    point[dimension + choice_dimension]);
        if (!sample) break;
        const glm::vec3 d = crossing.frame * sample->direction;
        const bool refracted = sample->direction.z < 0.0F;
        // The side of the interpolated normal must be the triangle's.
        if ((glm::dot(d, hit->geometric_normal) > 0.0F) != (refracted != crossing.entering)) break;
        throughput *=
            sample->weight * (refracted ? crossing.material.color : crossing.material.reflection_color);
        left = refracted && !crossing.entering;
        pdf = lit && refracted != crossing.entering ? sample->pdf : 0.0F;
        if (refracted) media.cross(*hit, crossing.entering);
        ray = {beside(*hit, d), d};
    }
    return {sum, 1.0F};
}

PathTracer::PathTracer(Scene scene, const PathSettings& settings)
    : scene_(std::move(scene)), settings_(settings), rect_(rendered_rect(settings.size, settings.region)) {
    if (settings_.size.x < 1 || settings_.size.y < 1) throw Error("A picture needs at least one pixel.");
    if (rect_.empty()) throw Error("The render region lies outside of the picture.");
    paths_ = std::make_unique<const Paths>(scene_, settings_);
    const std::size_t pixels = std::size_t(rect_.size().x) * rect_.size().y;
    sums_.assign(pixels, glm::vec4(0.0F));
    normal_depth_.resize(pixels);
    row_samples_.assign(rect_.size().y, 0);
}

PathTracer::~PathTracer() = default;

void PathTracer::trace_row(int row) {
    const int sample = row_samples_[row]++;
    const int y = rect_.begin.y + row;
    for (int x = rect_.begin.x; x < rect_.end.x; ++x) {
        const std::size_t pixel =
            std::size_t(y) * settings_.size.x + x;  // of the whole frame: as without a region
        const SobolPoint point(pixel, static_cast<std::uint32_t>(sample), settings_.seed);
        const glm::vec2 center(x + 0.5F, y + 0.5F);
        const glm::vec2 offset = blackman_harris_offset(point.pair(filter_dimension), settings_.filter_width);
        const std::size_t place = std::size_t(row) * rect_.size().x + (x - rect_.begin.x);
        sums_[place] += paths_->trace(paths_->camera_ray(center + offset), point);
        if (sample == 0) normal_depth_[place] = paths_->normal_depth(paths_->camera_ray(center));
    }
}

bool PathTracer::render(int samples, const Progress& progress) {
    using Clock = std::chrono::steady_clock;
    if (samples < 1) throw Error("A picture needs at least one sample.");
    const int block_rows = std::max(block_paths / rect_.size().x, 1);
    const int wanted = samples_ + samples;
    bool go_on = true;
    while (go_on && samples_ < wanted) {
        const Clock::time_point begin = Clock::now();
        // A render that was ended left rows of the first blocks one sample ahead.
        const int first = static_cast<int>(std::find(row_samples_.begin(), row_samples_.end(), samples_) -
                                           row_samples_.begin());
        const int last = std::min(first + block_rows, rect_.size().y);
        tbb::parallel_for(first, last, [this](int row) { trace_row(row); });
        seconds_ += std::chrono::duration<double>(Clock::now() - begin).count();
        if (last == rect_.size().y) ++samples_;
        if (progress) go_on = progress(samples_ + samples - wanted, samples);
    }
    return samples_ == wanted;
}

Frame PathTracer::frame() const {
    if (samples_ < 1) throw Error("A picture needs at least one sample.");
    Frame frame;
    frame.size = rect_.size();
    frame.combined = sums_;
    for (std::size_t i = 0; i < sums_.size(); ++i)
        frame.combined[i] /= static_cast<float>(row_samples_[i / rect_.size().x]);
    frame.normal_depth = normal_depth_;
    frame.seconds = seconds_;
    return frame;
}

}  // namespace verglas
