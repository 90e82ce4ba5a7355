// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/path_tracer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/material/layered_surface.h"
#include "core/material/microfacet.h"
#include "core/math/frame.h"
#include "core/math/pixel_filter.h"
#include "core/math/sobol.h"
#include "core/tracing/camera_rays.h"
#include "core/tracing/crossing.h"
#include "core/tracing/environment_light.h"
#include "core/tracing/media.h"
#include "core/tracing/ray_scene.h"
#include "core/tracing/scene_lights.h"

namespace verglas {
namespace {

// Coordinates of a sample's Sobol point: the pixel filter's, then those of each interface.
constexpr int filter_dimension = 0;
constexpr int first_interface_dimension = 2;
constexpr int interface_dimensions = 5;
constexpr int facet_dimension = 0;
constexpr int light_dimension = 2;
constexpr int choice_dimension = 4;
// Those of the scene's lights, apart, so that the others are alike with and without lights.
constexpr int first_scene_light_dimension = 1 << 20;
constexpr int scene_light_dimensions = 2;

constexpr float infinity = std::numeric_limits<float>::infinity();

// Surfaces that don't bend a ray, one behind the other; rounding must not keep it at one for ever.
constexpr int max_passed = 1000;

// Paths between two calls of progress.
constexpr int block_paths = 1 << 15;

// How many directions an interface draws from the environment's light, and how many by its own facets.
struct Split {
    int lights;
    int facets;
};
constexpr Split traced = {1, 1};
// At the exit of two_interface, where none of them costs a further ray.
constexpr Split untraced = {8, 4};

// Power heuristic for a sample of one of two strategies: of so many, with this density (Veach 1997).
float mis_weight(int samples, float pdf, int other_samples, float other_pdf) {
    const float p = static_cast<float>(samples) * pdf;
    const float q = static_cast<float>(other_samples) * other_pdf;
    return p * p + q * q > 0.0F ? p * p / (p * p + q * q) : 0.0F;
}

// An interface as a path meets it.
struct Crossing {
    const Hit* hit;
    bool is_layer;      // one of several at the same place, between which the path has no medium
    bool entering;      // the path is outside; behind the interface is glass
    glm::vec3 outward;  // unit normal of the triangle on the side that is outside
    glm::mat3 frame;
    glm::vec3 o;  // toward the viewer, in the frame
    RoughInterface surface;
    glm::vec3 color;                               // factor of what is refracted
    glm::vec3 reflection_color;                    // and reflected
    const LayeredBsdf* bsdf = nullptr;             // in place of the surface and its colours
    std::optional<RoughInterface::Event> event{};  // the only one that is followed
};

// Whether there may be surfaces that light goes through unbent.
bool has_straight_surfaces(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& material) {
        return material.kind == MaterialKind::Solid &&
               (material.priority > 0 || std::abs(material.ior - 1.0F) < MediumStack::min_index_step);
    });
}

// Where a path goes on.
struct Scattered {
    glm::vec3 d;
    bool refracted;
    glm::vec3 weight;
    float pdf;  // per steradian
};

// Light from outside, from i in the frame.
LayeredBsdf::Value evaluate(const Crossing& crossing, const glm::vec3& i) {
    if (crossing.bsdf) return crossing.bsdf->evaluate(i);
    const RoughInterface::Value value = crossing.surface.evaluate(crossing.o, i);
    return {value.f_cos * (crossing.entering ? crossing.reflection_color : crossing.color), value.pdf};
}

std::optional<Scattered> scatter_by_bsdf(const Crossing& crossing, glm::vec2 u, float choice) {
    const auto sample = crossing.bsdf->sample(u, choice);
    if (!sample) return std::nullopt;
    const glm::vec3 d = crossing.frame * sample->direction;
    if (glm::dot(d, crossing.outward) <= 0.0F) return std::nullopt;
    return Scattered{d, false, sample->weight, sample->pdf};
}

// u, choice: as for RoughInterface::sample().
std::optional<Scattered> scatter(const Crossing& crossing, glm::vec2 u, float choice) {
    if (crossing.bsdf) return scatter_by_bsdf(crossing, u, choice);
    const auto sample = crossing.event ? crossing.surface.sample(crossing.o, u, *crossing.event)
                                       : crossing.surface.sample(crossing.o, u, choice);
    if (!sample) return std::nullopt;
    const glm::vec3 d = crossing.frame * sample->direction;
    const bool refracted = sample->direction.z < 0.0F;
    // The side of the interpolated normal must be the triangle's, but for what stays in a layer.
    const bool goes_out = refracted != crossing.entering;
    if ((goes_out || !crossing.is_layer) && (glm::dot(d, crossing.outward) > 0.0F) != goes_out)
        return std::nullopt;
    const glm::vec3& color = refracted ? crossing.color : crossing.reflection_color;
    return Scattered{d, refracted, sample->weight * color, sample->pdf};
}

// A path from the camera, as far as it is known.
struct Path {
    Ray ray;
    glm::vec3 light{0.0F};  // that it has met
    glm::vec3 throughput{1.0F};
    MediumStack media;
    // Of the directions that its last interface draws from the environment, and of the ray's among those that
    // it scatters; pdf 0 where light_from() has no part in it.
    EnvironmentLight::Lobe lobe;
    float pdf = 0.0F;
    int interfaces = 0;  // met so far
};

}  // namespace

class PathTracer::Paths {
  public:
    Paths(const Scene& scene, const PathSettings& settings)
        : scene_(scene),
          settings_(settings),
          camera_(scene.camera, settings.size),
          rays_(scene),
          light_(scene),
          lights_(scene),
          has_straight_surfaces_(has_straight_surfaces(scene)) {}

    const CameraRays& camera() const { return camera_; }
    glm::vec4 trace(Ray ray, const SobolPoint& point) const;
    glm::vec4 normal_depth(const Ray& ray) const;

  private:
    bool two_interface() const { return settings_.mode == PathMode::TwoInterface; }
    Reflected reflected(const Material& material) const;
    std::optional<Hit> next_interface(Ray& ray, MediumStack& media, glm::vec3& throughput,
                                      float distance = infinity) const;
    glm::vec3 escape(Ray ray, MediumStack media, float distance) const;
    Crossing cross(const Hit& hit, const glm::vec3& d, const MediumStack& media) const;
    EnvironmentLight::Lobe outer_lobe(const Crossing& crossing) const;
    glm::vec3 light_from(const EnvironmentLight::Sample& light, const Crossing& crossing,
                         const MediumStack& media, Split split) const;
    glm::vec3 scene_light(const Crossing& crossing, const MediumStack& media, const SobolPoint& point,
                          int interface) const;
    glm::vec3 light_along(const Ray& ray, const MediumStack& media, float pdf) const;
    glm::vec3 light_toward(const Crossing& crossing, MediumStack media, const glm::vec3& direction,
                           float distance, int light_samples, float light_pdf, int facet_samples) const;
    glm::vec3 exit_light(const Crossing& crossing, const MediumStack& media, const SobolPoint& point,
                         int dimension) const;
    glm::vec3 environment_at(const Path& path) const;
    std::optional<Scattered> meet(Path& path, const Crossing& crossing, const SobolPoint& point,
                                  bool lit) const;
    bool meet_solid(Path& path, const Hit& hit, const SobolPoint& point) const;
    bool meet_layer(Path& path, const Hit& hit, const SobolPoint& point) const;

    const Scene& scene_;
    const PathSettings& settings_;
    CameraRays camera_;
    RayScene rays_;
    EnvironmentLight light_;
    SceneLights lights_;
    bool has_straight_surfaces_;
};

glm::vec4 PathTracer::Paths::normal_depth(const Ray& ray) const {
    const auto hit = rays_.intersect(ray.origin, ray.d);
    if (!hit) return {0.0F, 0.0F, 0.0F, 1e10F};
    return {hit->normal, camera_.depth(hit->position)};
}

// Blender's Refraction BSDF, without Fresnel, has no reflection.
Reflected PathTracer::Paths::reflected(const Material& material) const {
    if (two_interface()) return settings_.tir ? Reflected::Total : Reflected::None;
    return material.fresnel ? Reflected::All : Reflected::None;
}

// Takes a ray to the next surface that bends light, through those that don't; throughput: what is left of it
// there. None where the ray escapes, or comes to the distance before.
std::optional<Hit> PathTracer::Paths::next_interface(Ray& ray, MediumStack& media, glm::vec3& throughput,
                                                     float distance) const {
    for (int passed = 0; passed <= max_passed; ++passed) {
        const auto hit = rays_.intersect(ray.origin, ray.d);
        if (!hit || hit->t > distance) return std::nullopt;
        distance -= hit->t;
        const Material& material = scene_.materials[hit->material];
        const bool is_layer = material.kind != MaterialKind::Solid;
        const bool entering = is_entering(*hit, ray.d);
        throughput *= media.transmittance(scene_, *hit, entering || is_layer);
        if (is_layer) return hit;
        const MediumStack::Interface interface = media.interface(scene_, *hit, entering);
        if (interface.bends()) return hit;
        if (interface.is_real) throughput *= material.color;
        media.cross(*hit, entering);
        ray.origin = beside(*hit, ray.d);
    }
    throughput = glm::vec3(0.0F);
    return std::nullopt;
}

// The share of light that comes along a ray, unbent, from the environment or from a light so far away.
glm::vec3 PathTracer::Paths::escape(Ray ray, MediumStack media, float distance) const {
    if (!has_straight_surfaces_) return glm::vec3(rays_.escapes(ray.origin, ray.d, distance) ? 1.0F : 0.0F);
    glm::vec3 share(1.0F);
    return next_interface(ray, media, share, distance) ? glm::vec3(0.0F) : share;
}

Crossing PathTracer::Paths::cross(const Hit& hit, const glm::vec3& d, const MediumStack& media) const {
    const Material& material = scene_.materials[hit.material];
    const bool entering = is_entering(hit, d);
    const glm::mat3 frame = frame_of(facing_normal(hit, d));
    const float alpha = facet_alpha(roughness_at(material, hit));
    const RoughInterface surface(material.ndf, alpha, media.interface(scene_, hit, entering).eta,
                                 material.fresnel, reflected(material));
    return {&hit,
            false,
            entering,
            hit.geometric_normal,
            frame,
            glm::transpose(frame) * -d,
            surface,
            material.color,
            material.reflection_color};
}

// For light from outside: that an interface reflects to a path that is outside, or refracts to one inside.
EnvironmentLight::Lobe PathTracer::Paths::outer_lobe(const Crossing& crossing) const {
    const RoughInterface::Lobe lobe =
        crossing.bsdf ? crossing.bsdf->lobe() : crossing.surface.lobe(crossing.o, crossing.entering);
    return light_.lobe(crossing.frame * lobe.axis, lobe.kappa);
}

// What an interface sends toward o of light that comes from outside along a direction, for a radiance of 1:
// f cos, with the direction's own weight among those that light and facets draw. media: those on the side of
// o.
glm::vec3 PathTracer::Paths::light_toward(const Crossing& crossing, MediumStack media,
                                          const glm::vec3& direction, float distance, int light_samples,
                                          float light_pdf, int facet_samples) const {
    if (glm::dot(direction, crossing.outward) <= 0.0F) return glm::vec3(0.0F);
    const glm::vec3 i = glm::transpose(crossing.frame) * direction;
    if ((i.z > 0.0F) != crossing.entering) return glm::vec3(0.0F);
    const LayeredBsdf::Value value = evaluate(crossing, i);
    if (value.f_cos == glm::vec3(0.0F)) return glm::vec3(0.0F);
    const float weight =
        light_pdf > 0.0F ? mis_weight(light_samples, light_pdf, facet_samples, value.pdf) : 1.0F;
    if (!crossing.is_layer && i.z < 0.0F) media.cross(*crossing.hit, crossing.entering);
    const glm::vec3 visible = two_interface()
                                  ? glm::vec3(1.0F)
                                  : escape({beside(*crossing.hit, direction), direction}, media, distance);
    return visible * value.f_cos * weight;
}

// Light that an interface sends toward o from a direction drawn from the environment; the split's others
// aside.
glm::vec3 PathTracer::Paths::light_from(const EnvironmentLight::Sample& light, const Crossing& crossing,
                                        const MediumStack& media, Split split) const {
    if (light.pdf <= 0.0F) return glm::vec3(0.0F);
    return light_toward(crossing, media, light.direction, infinity, split.lights, light.pdf, split.facets) *
           light.radiance / light.pdf;
}

// The same from the scene's lights, each of which is drawn once.
glm::vec3 PathTracer::Paths::scene_light(const Crossing& crossing, const MediumStack& media,
                                         const SobolPoint& point, int interface) const {
    glm::vec3 sum(0.0F);
    for (std::size_t k = 0; k < lights_.size(); ++k) {
        const auto place = static_cast<int>(interface * lights_.size() + k);
        const glm::vec2 u = point.pair(first_scene_light_dimension + place * scene_light_dimensions);
        const SceneLights::Sample light = lights_.sample(k, crossing.hit->position, u);
        const glm::vec3 light_per_sample = light.pdf > 0.0F ? light.light / light.pdf : light.light;
        sum += light_per_sample *
               light_toward(crossing, media, light.direction, light.distance, 1, light.pdf, 1);
    }
    return sum;
}

// That of the scene's lights which a scattered ray meets. pdf: as Path's.
glm::vec3 PathTracer::Paths::light_along(const Ray& ray, const MediumStack& media, float pdf) const {
    glm::vec3 sum(0.0F);
    for (std::size_t k = 0; k < lights_.size(); ++k) {
        const auto light = lights_.at(k, ray.origin, ray.d);
        if (!light) continue;
        const float weight = pdf > 0.0F ? mis_weight(1, pdf, 1, light->pdf) : 1.0F;
        sum += light->light * weight * escape(ray, media, light->distance);
    }
    return sum;
}

// All light of the environment that a path inside meets by leaving here.
glm::vec3 PathTracer::Paths::exit_light(const Crossing& crossing, const MediumStack& media,
                                        const SobolPoint& point, int dimension) const {
    const EnvironmentLight::Lobe lobe = outer_lobe(crossing);
    glm::vec3 by_lights(0.0F);
    for (int k = 0; k < untraced.lights; ++k) {
        const glm::vec2 u = point.part(k, untraced.lights).pair(dimension + light_dimension);
        by_lights += light_from(light_.sample(lobe, u), crossing, media, untraced);
    }
    glm::vec3 by_facets(0.0F);
    for (int k = 0; k < untraced.facets; ++k) {
        const SobolPoint part = point.part(k, untraced.facets);
        const auto scattered =
            scatter(crossing, part.pair(dimension + facet_dimension), part[dimension + choice_dimension]);
        if (!scattered || !scattered->refracted) continue;
        const EnvironmentLight::Sample light = light_.at(lobe, scattered->d);
        const float weight = mis_weight(untraced.facets, scattered->pdf, untraced.lights, light.pdf);
        by_facets += scattered->weight * weight * light.radiance;
    }
    return by_lights / static_cast<float>(untraced.lights) + by_facets / static_cast<float>(untraced.facets);
}

// Of the direction in which a path escapes.
glm::vec3 PathTracer::Paths::environment_at(const Path& path) const {
    if (path.pdf <= 0.0F) return light_.radiance(path.ray.d);
    const EnvironmentLight::Sample light = light_.at(path.lobe, path.ray.d);
    return light.radiance * mis_weight(traced.facets, path.pdf, traced.lights, light.pdf);
}

// Adds what an interface sends to the path of the light that comes straight to its outer side, where it is
// lit, and scatters the path; none where it ends.
std::optional<Scattered> PathTracer::Paths::meet(Path& path, const Crossing& crossing,
                                                 const SobolPoint& point, bool lit) const {
    const int interface = path.interfaces++;
    const int dimension = first_interface_dimension + interface * interface_dimensions;
    if (lit) {
        path.lobe = outer_lobe(crossing);
        const glm::vec2 u = point.pair(dimension + light_dimension);
        path.light +=
            path.throughput * (light_from(light_.sample(path.lobe, u), crossing, path.media, traced) +
                               scene_light(crossing, path.media, point, interface));
    }
    const auto scattered =
        scatter(crossing, point.pair(dimension + facet_dimension), point[dimension + choice_dimension]);
    if (!scattered) return scattered;
    path.throughput *= scattered->weight;
    path.pdf = lit && scattered->refracted != crossing.entering ? scattered->pdf : 0.0F;
    return scattered;
}

bool PathTracer::Paths::meet_solid(Path& path, const Hit& hit, const SobolPoint& point) const {
    const Crossing crossing = cross(hit, path.ray.d, path.media);
    const bool exit = two_interface() && !crossing.entering;
    const bool lit = !two_interface() && (!crossing.entering || scene_.materials[hit.material].fresnel);
    if (exit) {
        const int dimension = first_interface_dimension + path.interfaces * interface_dimensions;
        path.light += path.throughput * (exit_light(crossing, path.media, point, dimension) +
                                         scene_light(crossing, path.media, point, path.interfaces));
        if (!settings_.tir) return false;
    }
    const auto scattered = meet(path, crossing, point, lit);
    if (!scattered || (exit && scattered->refracted)) return false;
    if (scattered->refracted) path.media.cross(hit, crossing.entering);
    path.ray = {beside(hit, scattered->d), scattered->d};
    return true;
}

// What an interface of a coating has to do with the one bounce whose light is wanted, when so many are done.
void take_all_paths(Crossing& crossing, int bounces, int wanted) {
    if (crossing.entering)
        crossing.event = wanted > 0 ? std::optional(RoughInterface::Event::Refract) : std::nullopt;
    else if (bounces < wanted)
        crossing.event = RoughInterface::Event::Reflect;
    else
        crossing.surface = crossing.surface.refracting();
}

// Follows a path through a thin layer, from interface to interface, until it leaves.
bool PathTracer::Paths::meet_layer(Path& path, const Hit& hit, const SobolPoint& point) const {
    const Material& material = scene_.materials[hit.material];
    const bool entering = is_entering(hit, path.ray.d);
    const LayeredSurface layer(material, entering, facet_alpha(roughness_at(material, hit)),
                               facet_alpha(inner_roughness_at(material, hit)));
    const glm::vec3 n = facing_normal(hit, path.ray.d);
    const glm::vec3 outward = entering ? hit.geometric_normal : -hit.geometric_normal;
    const glm::mat3 front = frame_of(n);
    const glm::mat3 back = frame_of(-n);
    const auto inside = [&](bool is_near, const glm::vec3& d) {
        const glm::mat3& frame = is_near ? back : front;
        return Crossing{&hit,
                        true,
                        false,
                        is_near ? outward : -outward,
                        frame,
                        glm::transpose(frame) * -d,
                        is_near ? layer.near() : *layer.far(),
                        material.color,
                        glm::vec3(1.0F)};
    };
    Crossing crossing{&hit,
                      true,
                      true,
                      outward,
                      front,
                      glm::transpose(front) * -path.ray.d,
                      layer.outside(),
                      material.color,
                      material.reflection_color};
    std::optional<LayeredBsdf> bsdf;
    if (material.kind == MaterialKind::Coated && settings_.layers != LayerModel::Recursive) {
        bsdf.emplace(settings_.layers, material, layer, crossing.o, settings_.bounce);
        crossing.bsdf = &*bsdf;
    }
    const std::optional<int> wanted =
        material.kind == MaterialKind::Coated && !bsdf ? settings_.bounce : std::nullopt;
    const int kept = material.fresnel ? material.layer.bounces : std::min(material.layer.bounces, 1);
    if (wanted > kept) return false;
    const int most_bounces = wanted.value_or(kept);
    int bounces = 0;
    while (path.interfaces <= settings_.max_interfaces) {
        if (wanted) take_all_paths(crossing, bounces, *wanted);
        const bool lit = !crossing.event && (!crossing.entering || crossing.bsdf || material.fresnel);
        const auto scattered = meet(path, crossing, point, lit);
        if (!scattered) return false;
        glm::vec3 d = scattered->d;
        if (scattered->refracted != crossing.entering) {
            path.ray = {beside(hit, d), d};
            return true;
        }
        const bool is_near = glm::dot(d, n) > 0.0F;
        if (is_near || layer.far()) {
            crossing = inside(is_near, d);
            continue;
        }
        if (++bounces > most_bounces || path.interfaces > settings_.max_interfaces) return false;
        const int dimension = first_interface_dimension + path.interfaces++ * interface_dimensions;
        const glm::vec3 o = glm::transpose(front) * -d;
        const auto reflected = layer.base().sample(o, point.pair(dimension + facet_dimension));
        if (!reflected) return false;
        path.throughput *=
            reflected->weight * layer.transmittance(o.z) * layer.transmittance(reflected->direction.z);
        d = front * reflected->direction;
        crossing = inside(true, d);
    }
    return false;
}

glm::vec4 PathTracer::Paths::trace(Ray ray, const SobolPoint& point) const {
    Path path;
    path.ray = ray;
    while (path.interfaces <= settings_.max_interfaces) {
        const auto hit = next_interface(path.ray, path.media, path.throughput);
        if (!hit) {
            if (path.ray.origin == ray.origin && settings_.transparent) return glm::vec4(0.0F);
            path.light += path.throughput * environment_at(path);
            break;
        }
        const bool is_solid = scene_.materials[hit->material].kind == MaterialKind::Solid;
        if (!(is_solid ? meet_solid(path, *hit, point) : meet_layer(path, *hit, point))) break;
        path.light += path.throughput * light_along(path.ray, path.media, path.pdf);
    }
    return {path.light, 1.0F};
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
        const std::size_t place = rect_.place({x, y});
        sums_[place] += paths_->trace(paths_->camera().through(center + offset), point);
        if (sample == 0) normal_depth_[place] = paths_->normal_depth(paths_->camera().through(center));
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
    frame.combined.assign(sums_.begin(), sums_.end());
    for (std::size_t i = 0; i < sums_.size(); ++i)
        frame.combined[i] /= static_cast<float>(row_samples_[i / rect_.size().x]);
    frame.normal_depth.assign(normal_depth_.begin(), normal_depth_.end());
    frame.seconds = seconds_;
    return frame;
}

}  // namespace verglas
