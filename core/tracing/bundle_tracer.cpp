// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/bundle_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "core/material/microfacet.h"
#include "core/material/pane_walk.h"
#include "core/math/frame.h"
#include "core/math/pixel_filter.h"
#include "core/math/sobol.h"
#include "core/math/von_mises_fisher.h"
#include "core/tracing/crossing.h"
#include "core/tracing/divergence.h"
#include "core/tracing/first_rays.h"
#include "core/tracing/layer_lobes.h"
#include "core/tracing/media.h"

namespace verglas {
namespace {

// How paths branch, as shares of the light that reaches the pixel. Found by measurement (method: 5.5): full
// glass, roughness 0.25 and 0.55, sphere, monkey, bottle and gem. With a quarter of the first, frames
// take 1.4 to 2 times as long, and the error falls by a third on the sphere of 0.25, by a seventh on monkey
// and bottle of 0.25, and rises or stays elsewhere; half of the second and twice as many interfaces change
// next to nothing.
constexpr float split_weight = 0.08F;   // reflected and refracted light are both followed above it
constexpr float least_weight = 0.004F;  // the greater of the two is followed above it

// Drawn branches with less light than this are followed by chance, and then stand for as much.
constexpr float least_drawn_weight = 0.02F;
constexpr int max_drawn_interfaces = 64;  // longer paths end, as the path tracer's

// Coordinates of a drawn ray's Sobol point: the front lobe's, then those of each further interface.
constexpr int front_dimension = 2;
constexpr int first_inner_dimension = 4;
constexpr int inner_dimensions = 6;
constexpr int chance_dimension = 2;      // of the three of an event
constexpr int reflection_dimension = 3;  // the reflected branch has its own
// Those of walks in panes come after all of these.
constexpr int first_walk_dimension = first_inner_dimension + max_drawn_interfaces * inner_dimensions;
constexpr int walk_dimensions = 3 * PaneWalk::most_steps;

// A narrower front lobe is one ray: more would land in the same pixels of anything.
constexpr float least_bundle_spread = 1e-6F;

// Of the front lobe's variance, to one pair of rays that leave through clear glass; more pairs need less.
constexpr float most_left = 0.5F;

using model::greatest;

// The direction, bent to leave to the side of the triangle that a normal shows to: interpolated normals may
// send it to the other.
glm::vec3 on_side(const glm::vec3& d, const glm::vec3& side) {
    constexpr float least_cosine = 1e-3F;
    const float cosine = glm::dot(d, side);
    return cosine >= least_cosine ? d : glm::normalize(d + (least_cosine - cosine) * side);
}

std::uint64_t pixel_number(glm::ivec2 pixel, const Settings& settings) {
    return std::uint64_t(pixel.y) * settings.size.x + pixel.x;
}

// The part of the last lobe's variance that a drawn direction brings; the rest is looked up. It grows, so
// that the pictures' mean converges to that of whole drawn lobes.
float drawn_part(int sample) { return 1.0F - 1.0F / std::cbrt(static_cast<float>(sample)); }

// Between a lobe's mean direction and one that was drawn from it, with a part of the variance of the latter.
glm::vec3 between(const glm::vec3& mean, const glm::vec3& drawn, float part) {
    return glm::normalize(glm::mix(mean, drawn, std::sqrt(part)));
}

// The part of what has spread before an interface that the look-up keeps, although directions were drawn
// there, too: small suns would else be met by few rays in a hundred pixels, and their light show as spots
// (path regularization: Kaplanyan and Dachsbacher 2013). It fades away. With a part of 1 at first there is
// less noise, but light between facets is farther from the truth for longer; without, spots are left at 16
// samples.
float carried_part(int sample) { return 0.3F / std::sqrt(static_cast<float>(sample)); }

}  // namespace

// What a ray brings to a pixel, and the lobe about it.
struct BundleTracer::Beam {
    glm::vec3 weight{1.0F};   // of the radiance that it brings
    glm::vec3 axis;           // of the lobe that is looked up if the ray meets nothing more
    Divergence divergence{};  // of that lobe, without the part that the bundle's rays stand for
    float carried = 1.0F;     // part of it that the next interface keeps
    // Outward normal of the interface that it last left through; 0 if it was reflected since.
    glm::vec3 exit{0.0F};
    bool has_tail = false;  // the lobe of the last interface
    glm::ivec2 pixel;
    int number = 0;      // of the bundle's ray, from 0
    int interfaces = 0;  // crossed
    MediumStack media{};
};

// A beam at an interface that bends it.
struct BundleTracer::Meeting {
    Beam beam;           // with what the last medium has left of it
    const glm::vec3& d;  // of its ray
    const Hit& hit;
    const Material& material;
    glm::vec3& radiance;  // of the pixel
    bool entering;
    glm::vec3 n;  // toward where the beam comes from
    float roughness;
    float eta;

    glm::vec3 side(const Branch& branch) const;  // the triangle's normal, to where the branch goes
    bool is_front_refraction(const Branch& branch) const;
    bool is_outside(const Branch& branch) const;
};

// How light goes on at a surface.
enum class BundleTracer::Way {
    Reflected,
    Refracted,
    Through,  // a pane, straight on in the mean
};

// What an interface makes of a beam.
struct BundleTracer::Branch {
    Way way;
    model::Lobe lobe;
    glm::vec3 color;
    glm::vec3 weight;  // the beam's, the lobe's and the colour
};

// Of the environment under lobes.
struct BundleTracer::Lookups {
    std::array<glm::vec3, LayerLobes::most_lobes> weights;
    std::array<glm::vec3, LayerLobes::most_lobes> directions;
    std::array<float, LayerLobes::most_lobes> spreads;
    std::size_t count = 0;

    void add(const glm::vec3& weight, const glm::vec3& direction, float spread) {
        weights[count] = weight;
        directions[count] = direction;
        spreads[count++] = spread;
    }
};

glm::vec3 BundleTracer::Meeting::side(const Branch& branch) const {
    return (branch.way == Way::Reflected) == entering ? hit.geometric_normal : -hit.geometric_normal;
}

// Whether the bundle's rays stand for the branch.
bool BundleTracer::Meeting::is_front_refraction(const Branch& branch) const {
    return beam.interfaces == 0 && branch.way != Way::Reflected;
}

// Beams that have crossed the same number of interfaces, and their rays.
struct BundleTracer::Wave {
    std::vector<Beam> beams;
    std::vector<Ray> rays;

    void clear() {
        beams.clear();
        rays.clear();
    }
};

// What the camera sees along rays.
struct BundleTracer::View {
    std::vector<Ray> rays;
    std::vector<Hit> hits;
    std::vector<glm::vec3> backgrounds;  // by ray; 0 where something is in front
    // Of rays that meet nothing: of the map, and what comes from there.
    std::vector<glm::vec3> directions;
    std::vector<glm::vec3> radiances;

    void clear() { rays.clear(); }
    // By parts: a ray that is copied as it was written waits for its memory.
    void add(const Ray& ray) {
        Ray& added = rays.emplace_back();
        added.origin = ray.origin;
        added.d = ray.d;
    }
};

glm::vec2 sample_offset(glm::ivec2 pixel, int sample, const Settings& settings) {
    if (sample == 0) return glm::vec2(0.0F);
    const SobolPoint point(pixel_number(pixel, settings), static_cast<std::uint32_t>(sample), 0);
    return blackman_harris_offset(point.pair(0), settings.filter_width);
}

BundleTracer::BundleTracer(const TracedScene& scene, const Settings& settings, int sample)
    : scene_(scene),
      settings_(settings),
      camera_(scene.scene().camera, glm::vec2(settings.size) / static_cast<float>(settings.pixel_size)),
      sample_(sample) {}

void BundleTracer::trace(const Rect& tile, TracedPicture& picture) const {
    thread_local Wave wave;
    thread_local Wave next;
    thread_local std::vector<Hit> hits;
    next.clear();
    start(tile, picture, next);
    while (!next.rays.empty()) {
        std::swap(wave, next);
        hits.resize(wave.rays.size());
        scene_.rays().intersect(wave.rays, hits);
        next.clear();
        for (std::size_t i = 0; i < hits.size(); ++i) {
            const Beam& beam = wave.beams[i];
            if (hits[i].object >= 0)
                meet(beam, wave.rays[i].d, hits[i], picture, next);
            else
                picture.radiance[picture.place(beam.pixel.x, beam.pixel.y)] += looked_up(beam);
        }
    }
}

void BundleTracer::look(std::span<const glm::vec2> places, std::span<Sight> sights) const {
    thread_local View view;
    view.clear();
    for (const glm::vec2& place : places) view.add(camera_.through(place));
    see(view);
    for (std::size_t i = 0; i < places.size(); ++i) sights[i] = {view.hits[i].object, view.backgrounds[i]};
}

void BundleTracer::see(View& view) const {
    view.hits.resize(view.rays.size());
    scene_.rays().intersect(view.rays, view.hits);
    view.backgrounds.assign(view.rays.size(), glm::vec3(0.0F));
    if (settings_.background_alpha == 0.0F) return;
    view.directions.clear();
    for (std::size_t i = 0; i < view.rays.size(); ++i)
        if (view.hits[i].object < 0) view.directions.push_back(view.rays[i].d);
    view.radiances.resize(view.directions.size());
    const float spread = std::max(settings_.background_spread, model::LOBE_MIN_SPREAD);
    scene_.incoming_radiance(view.directions, std::span(&spread, 1), view.radiances);
    auto radiance = view.radiances.begin();
    for (std::size_t i = 0; i < view.rays.size(); ++i)
        if (view.hits[i].object < 0) view.backgrounds[i] = settings_.background_alpha * *radiance++;
}

// From the camera to the first interfaces.
void BundleTracer::start(const Rect& tile, TracedPicture& picture, Wave& next) const {
    thread_local View view;
    view.clear();
    glm::ivec2 pixel;
    for (pixel.y = tile.begin.y; pixel.y < tile.end.y; ++pixel.y) {
        for (pixel.x = tile.begin.x; pixel.x < tile.end.x; ++pixel.x) {
            const glm::vec2 center = glm::vec2(pixel) + 0.5F;
            view.add(camera_.through(center + sample_offset(pixel, sample_, settings_)));
        }
    }
    see(view);
    for (pixel.y = tile.begin.y; pixel.y < tile.end.y; ++pixel.y) {
        for (pixel.x = tile.begin.x; pixel.x < tile.end.x; ++pixel.x) {
            const std::size_t place = picture.place(pixel.x, pixel.y);
            const std::size_t i = tile.place(pixel);
            picture.surfaces[place] = Surface::none();
            picture.radiance[place] = view.backgrounds[i];
            const glm::vec3& d = view.rays[i].d;
            if (view.hits[i].object >= 0) meet({.axis = d, .pixel = pixel}, d, view.hits[i], picture, next);
        }
    }
}

void BundleTracer::meet(const Beam& incoming, const glm::vec3& d, const Hit& hit, TracedPicture& picture,
                        Wave& next) const {
    const Scene& scene = scene_.scene();
    const Material& material = scene.materials[hit.material];
    Meeting meeting{.beam = incoming,
                    .d = d,
                    .hit = hit,
                    .material = material,
                    .radiance = picture.radiance[picture.place(incoming.pixel.x, incoming.pixel.y)],
                    .entering = is_entering(hit, d),
                    .n = facing_normal(hit, d),
                    .roughness = roughness_at(material, hit),
                    .eta = 1.0F};
    Surface& surface = picture.surfaces[picture.place(incoming.pixel.x, incoming.pixel.y)];
    if (incoming.interfaces == 0 && surface.object < 0)
        surface = {hit.normal, camera_.depth(hit.position), hit.object,
                   model::alpha_from_roughness(meeting.roughness)};

    Beam& beam = meeting.beam;
    beam.divergence.travel(hit.t);
    const bool is_thin = material.kind != MaterialKind::Solid;
    beam.weight *= beam.media.transmittance(scene, hit, meeting.entering || is_thin);
    if (is_thin) {
        if (!meeting.entering && material.kind == MaterialKind::Pane)
            meeting.roughness = inner_roughness_at(material, hit);
        meeting.eta = material.ior;
        return meet_layer(meeting, next);
    }
    const MediumStack::Interface interface = beam.media.interface(scene, hit, meeting.entering);
    if (!interface.bends()) {
        if (interface.is_real) beam.weight *= material.color;
        beam.media.cross(hit, meeting.entering);
        if (++beam.interfaces <= max_drawn_interfaces) {
            next.beams.push_back(beam);
            next.rays.push_back({beside(hit, d), d});
        }
        return;
    }
    meeting.eta = interface.eta;

    const InterfaceTables& tables = scene_.tables(hit.material, interface.eta);
    Branch refracted{.way = Way::Refracted,
                     .lobe = scene_.lobes().refracted_lobe(tables.refraction, interface.eta,
                                                           meeting.roughness, d, meeting.n, model::TIR_NONE),
                     .color = material.color,
                     .weight = {}};
    refracted.weight = beam.weight * refracted.lobe.energy * refracted.color;
    const bool reflects = tables.reflection >= 0 && settings_.reflection && settings_.paths == PathMode::Full;
    if (!reflects) return branch_off(meeting, refracted, true, next);
    Branch reflected{.way = Way::Reflected,
                     .lobe = scene_.lobes().reflected_lobe(tables.reflection, interface.eta,
                                                           meeting.roughness, d, meeting.n),
                     .color = material.reflection_color,
                     .weight = {}};
    reflected.weight = beam.weight * reflected.lobe.energy * reflected.color;
    const bool refracts_more = greatest(refracted.weight) >= greatest(reflected.weight);
    branch_off(meeting, refracted, refracts_more, next);
    branch_off(meeting, reflected, !refracts_more, next);
}

void BundleTracer::meet_layer(const Meeting& meeting, Wave& next) const {
    if (sample_ > 0 && meeting.material.kind == MaterialKind::Pane) return draw_layer(meeting, next);
    const LayerLobes lobes = LayerLobes::of(scene_, meeting.hit, meeting.d, meeting.n, meeting.entering);
    if (sample_ > 0) {
        if (settings_.reflection) draw_mirrored(meeting, lobes, next);
        return draw_from_within(meeting, lobes, next);
    }
    const LayerLobe* greatest_lobe = nullptr;
    float greatest_weight = 0.0F;
    for (const LayerLobe& lobe : lobes.all()) {
        const float weight = lobe.lobe.energy * greatest(lobe.color);
        if (weight <= greatest_weight) continue;
        greatest_weight = weight;
        greatest_lobe = &lobe;
    }
    const Divergence reflected = turned(meeting.beam.divergence, meeting, Way::Reflected);
    const bool lit = !scene_.scene().lights.empty();
    Lookups cut;  // of the lobes that aren't followed
    for (const LayerLobe& lobe : lobes.all()) {
        if (lobe.is_reflection(meeting.material) && !settings_.reflection) continue;
        const glm::vec3 weight = meeting.beam.weight * lobe.lobe.energy * lobe.color;
        const bool followed = is_followed(meeting, greatest(weight), &lobe == greatest_lobe);
        if (followed || lit) {
            const Branch branch = branch_of(meeting, lobe);
            light(meeting, branch);
            if (followed) go_on(meeting, branch, next);
        }
        if (followed) continue;
        const bool through = lobe.way == LayerLobe::Way::Through;
        const Divergence& before = through ? meeting.beam.divergence : reflected;
        cut.add(weight, lobe.lobe.direction, before.spread_with(lobe.lobe.spread));
    }
    meeting.radiance += looked_up(cut);
}

BundleTracer::Branch BundleTracer::branch_of(const Meeting& meeting, const LayerLobe& lobe) {
    return {.way = lobe.way == LayerLobe::Way::Through ? Way::Through : Way::Reflected,
            .lobe = lobe.lobe,
            .color = lobe.color,
            .weight = meeting.beam.weight * lobe.lobe.energy * lobe.color};
}

// By the outer side of a coating: one direction of all its lobes.
void BundleTracer::draw_mirrored(const Meeting& meeting, const LayerLobes& lobes, Wave& next) const {
    if (meeting.beam.interfaces >= max_drawn_interfaces) return;
    Branch whole{.way = Way::Reflected,
                 .lobe = {.energy = 0.0F, .spread = 0.0F, .direction = meeting.n},
                 .color = meeting.material.reflection_color,
                 .weight = glm::vec3(0.0F)};
    for (const LayerLobe& lobe : lobes.all()) {
        if (lobe.way != LayerLobe::Way::Mirrored) continue;
        const Branch branch = branch_of(meeting, lobe);
        light(meeting, branch);
        const float energy = whole.lobe.energy + lobe.lobe.energy;
        whole.lobe = model::joined_lobe(whole.lobe, lobe.lobe, lobe.lobe.energy / energy);
        whole.lobe.energy = energy;
        whole.weight += branch.weight;
    }
    if (greatest(whole.weight) > 0.0F) draw(meeting, whole, next);
}

// Light from the base of a coating: of its lobes four at the front, else one, drawn by their weight.
void BundleTracer::draw_from_within(const Meeting& meeting, const LayerLobes& lobes, Wave& next) const {
    if (meeting.beam.interfaces >= max_drawn_interfaces) return;
    float sum = 0.0F;
    for (const LayerLobe& lobe : lobes.all()) {
        if (lobe.way != LayerLobe::Way::FromWithin) continue;
        const Branch branch = branch_of(meeting, lobe);
        light(meeting, branch);
        sum += greatest(branch.weight);
    }
    const int count = meeting.beam.interfaces == 0 ? model::BUNDLE_RAYS : 1;
    for (int number = 0; number < count && sum > 0.0F; ++number) {
        Beam outgoing = meeting.beam;
        if (meeting.beam.interfaces == 0) outgoing.number = number;
        const SobolPoint point = point_of(outgoing);
        float choice = sum * point[first_walk_dimension + outgoing.interfaces * walk_dimensions + 2];
        for (const LayerLobe& lobe : lobes.all()) {
            if (lobe.way != LayerLobe::Way::FromWithin) continue;
            Branch branch = branch_of(meeting, lobe);
            const float weight = greatest(branch.weight);
            choice -= weight;
            if (choice >= 0.0F || weight <= 0.0F) continue;
            branch.weight *= sum / (weight * static_cast<float>(count));
            draw_lobe(meeting, branch, outgoing, next);
            break;
        }
    }
}

// A direction from a lobe as a spherical Gaussian, where it hasn't been drawn by facets.
void BundleTracer::draw_lobe(const Meeting& meeting, const Branch& branch, Beam outgoing, Wave& next) const {
    outgoing.weight = branch.weight;
    const SobolPoint point = point_of(outgoing);
    const int first = first_walk_dimension + outgoing.interfaces * walk_dimensions;
    const float chance = greatest(outgoing.weight) / least_drawn_weight;
    if (chance < 1.0F && outgoing.interfaces > 0) {
        if (point[first + 3] >= chance) return;
        outgoing.weight /= chance;
    }
    const float kappa = std::max(model::kappa_from_spread(branch.lobe.spread), 1e-3F);
    const glm::vec3 d =
        on_side(frame_of(branch.lobe.direction) * VonMisesFisher(kappa).sample(point.pair(first)),
                meeting.side(branch));
    look_between(meeting, branch, d, outgoing);
    next.beams.push_back(outgoing);
    send(meeting, branch, d, next);
}

void BundleTracer::branch_off(const Meeting& meeting, const Branch& branch, bool is_greater,
                              Wave& next) const {
    const float weight = greatest(branch.weight);
    if (weight <= 0.0F) return;
    light(meeting, branch);
    const Beam& beam = meeting.beam;
    if (sample_ > 0) {
        if (beam.interfaces < max_drawn_interfaces) draw(meeting, branch, next);
        return;
    }
    if (is_followed(meeting, weight, is_greater))
        go_on(meeting, branch, next);
    else
        meeting.radiance += cut_off(meeting, branch);
}

// Of the first sample. weight: a branch's greatest.
bool BundleTracer::is_followed(const Meeting& meeting, float weight, bool is_greater) const {
    return meeting.beam.interfaces < settings_.max_interfaces &&
           (weight >= split_weight || (is_greater && weight >= least_weight));
}

void BundleTracer::go_on(const Meeting& meeting, const Branch& branch, Wave& next) const {
    if (meeting.is_front_refraction(branch) && branch.lobe.spread >= least_bundle_spread)
        split(meeting, branch, next);
    else
        follow(meeting, branch, next);
}

// Whether it leaves to where the environment and the lights are.
bool BundleTracer::Meeting::is_outside(const Branch& branch) const {
    return material.kind != MaterialKind::Solid || (branch.way == Way::Reflected) == entering;
}

// Adds what a branch brings from the scene's lights. They are looked up under the interface's whole lobe
// where directions are drawn, too: rays would hardly ever meet them.
void BundleTracer::light(const Meeting& meeting, const Branch& branch) const {
    if (scene_.scene().lights.empty() || !meeting.is_outside(branch)) return;
    const glm::vec3 side = meeting.side(branch);
    const glm::vec3 d = on_side(branch.lobe.direction, side);
    const glm::vec3 position = beside(meeting.hit, side);
    const float spread = std::max(spread_after(meeting, branch), model::LOBE_MIN_SPREAD);
    const auto radiance = [&](float width) {
        return scene_.local_radiance(position, d, model::widened_spread(spread, width), side);
    };
    const bool has_tail = meeting.material.has_tails();
    meeting.radiance += branch.weight * (has_tail ? glm::mix(radiance(model::CORE_WIDTH),
                                                             radiance(model::TAIL_WIDTH), model::TAIL_SHARE)
                                                  : radiance(1.0F));
}

// What has spread before an interface, after it. It turns as at straight incidence: near the critical angle,
// where the law of refraction turns directions apart without bound, lobes don't follow it, and less error is
// left on the scenes above than with its derivatives there.
Divergence BundleTracer::turned(Divergence divergence, const Meeting& meeting, Way way) const {
    if (divergence.is_none() || way == Way::Through) return divergence;
    Curvature curvature = scene_.rays().curvature(meeting.hit);
    if (meeting.entering) curvature.mean = -curvature.mean;  // seen from outside
    const float scale = way == Way::Reflected ? 1.0F : 1.0F / meeting.eta;
    const float bend = way == Way::Reflected ? -2.0F : 1.0F - scale;
    divergence.turn(scale, bend, curvature);
    return divergence;
}

// Of a branch along its lobe's mean direction.
Divergence BundleTracer::divergence(const Meeting& meeting, const Branch& branch) const {
    Divergence result = turned(meeting.beam.divergence, meeting, branch.way);
    result.widen(Divergence::of_lobe(branch.lobe.spread));
    return result;
}

float BundleTracer::spread_after(const Meeting& meeting, const Branch& branch) const {
    return turned(meeting.beam.divergence, meeting, branch.way).spread_with(branch.lobe.spread);
}

// Along the lobe's mean direction.
void BundleTracer::follow(const Meeting& meeting, const Branch& branch, Wave& next) const {
    Beam& outgoing = next.beams.emplace_back(meeting.beam);
    outgoing.weight = branch.weight;
    outgoing.divergence = divergence(meeting, branch);
    outgoing.axis = on_side(branch.lobe.direction, meeting.side(branch));
    send(meeting, branch, outgoing.axis, next);
}

// The part of the front lobe's variance that is left to each of its rays. Where they leave through glass as
// rough as where they entered, none: its lobe is as wide as the ring of rays, and joins them. Clear glass
// would show eight pictures of a window in a ring, and nothing in its middle; with half of the variance left
// to rays at the mean distance, the sum of their lobes is as a Gaussian. Drawn rays are left less and less.
float BundleTracer::left_part(float roughness) const {
    const float ratio = facet_alpha(scene_.least_roughness()) / facet_alpha(roughness);
    return most_left * (1.0F - std::min(ratio * ratio, 1.0F)) /
           std::cbrt(static_cast<float>(std::max(sample_, 1)));
}

// Rays in place of the lobe, or of a part of its variance, which the rest of it blurs.
void BundleTracer::split(const Meeting& meeting, const Branch& branch, Wave& next) const {
    const std::span<const BundleRay> rays =
        first_rays(meeting.beam.pixel, scene_.roughness_varies(meeting.hit.object));
    const float share = 1.0F / static_cast<float>(rays.size());
    const float left = 2.0F * share * (branch.way == Way::Through ? most_left : left_part(meeting.roughness));
    Divergence divergence = meeting.beam.divergence;
    divergence.widen(Divergence::of_lobe(left * branch.lobe.spread));
    model::Lobe lobe = branch.lobe;
    for (int number = 0; number < static_cast<int>(rays.size()); ++number) {
        const BundleRay& ray = rays[number];
        const float squared_distance = glm::mix(ray.squared_distance, 1.0F, left / most_left);
        lobe.spread = std::min(squared_distance * (1.0F - left) * branch.lobe.spread, 1.0F);
        Beam& outgoing = next.beams.emplace_back(meeting.beam);
        outgoing.weight = share * branch.weight;
        outgoing.divergence = divergence;
        outgoing.number = number;
        outgoing.axis = on_side(model::bundle_ray(lobe, meeting.n, ray.azimuth), meeting.side(branch));
        send(meeting, branch, outgoing.axis, next);
    }
}

// Directions from the microfacets: four of the front's refraction, else one.
void BundleTracer::draw(const Meeting& meeting, const Branch& branch, Wave& next) const {
    Beam outgoing = meeting.beam;
    if (!meeting.is_front_refraction(branch)) return draw_ray(meeting, branch, outgoing, next);
    outgoing.weight /= static_cast<float>(model::BUNDLE_RAYS);
    for (outgoing.number = 0; outgoing.number < model::BUNDLE_RAYS; ++outgoing.number)
        draw_ray(meeting, branch, outgoing, next);
}

void BundleTracer::draw_ray(const Meeting& meeting, const Branch& branch, Beam outgoing, Wave& next) const {
    const SobolPoint point = point_of(outgoing);
    const int dimension = outgoing.interfaces == 0
                              ? front_dimension
                              : first_inner_dimension + (outgoing.interfaces - 1) * inner_dimensions +
                                    (branch.way == Way::Reflected ? reflection_dimension : 0);
    const float alpha = facet_alpha(meeting.roughness);
    const RoughInterface surface(normals_of(meeting.material, alpha), meeting.eta, meeting.material.fresnel,
                                 Reflected::All);
    const glm::mat3 frame = frame_of(meeting.n);
    const auto event =
        branch.way == Way::Reflected ? RoughInterface::Event::Reflect : RoughInterface::Event::Refract;
    const auto facet = surface.sample(glm::transpose(frame) * -meeting.d, point.pair(dimension), event);
    if (!facet) return;
    glm::vec3 d = frame * facet->direction;
    // The side of the interpolated normal must be the triangle's.
    if (glm::dot(d, meeting.side(branch)) <= 0.0F) return;
    outgoing.weight *= facet->weight * branch.color;
    // By what was drawn: the lobe's energy next to the critical angle says too little of it.
    const float chance = greatest(outgoing.weight) / least_drawn_weight;
    if (chance < 1.0F && !meeting.is_front_refraction(branch)) {
        if (point[dimension + chance_dimension] >= chance) return;
        outgoing.weight /= chance;
    }
    const float left = meeting.is_front_refraction(branch) ? left_part(meeting.roughness) : 0.0F;
    if (left > 0.0F) {
        d = outgoing.axis = on_side(between(branch.lobe.direction, d, 1.0F - left), meeting.side(branch));
        outgoing.divergence = Divergence::of_lobe(left * branch.lobe.spread);
        outgoing.carried = 1.0F;
    } else {
        look_between(meeting, branch, d, outgoing);
    }
    next.beams.push_back(outgoing);
    send(meeting, branch, d, next);
}

// For a drawn direction, how its light is looked up where the ray meets nothing.
void BundleTracer::look_between(const Meeting& meeting, const Branch& branch, const glm::vec3& d,
                                Beam& outgoing) const {
    const float drawn = drawn_part(sample_);
    outgoing.axis = between(branch.lobe.direction, d, drawn);
    outgoing.divergence = turned(meeting.beam.divergence.part(meeting.beam.carried), meeting, branch.way);
    outgoing.divergence.widen(Divergence::of_lobe((1.0F - drawn) * branch.lobe.spread));
    // The front's rays are enough to stand for its lobe.
    outgoing.carried = meeting.beam.interfaces > 0 ? carried_part(sample_) : 0.0F;
}

SobolPoint BundleTracer::point_of(const Beam& beam) const {
    return SobolPoint(pixel_number(beam.pixel, settings_), static_cast<std::uint32_t>(sample_), 0)
        .part(static_cast<std::uint32_t>(beam.number), model::BUNDLE_RAYS);
}

// Whole ways through a thin layer, each with one of its ends: four at the front, else one.
void BundleTracer::draw_layer(const Meeting& meeting, Wave& next) const {
    if (meeting.beam.interfaces >= max_drawn_interfaces) return;
    if (settings_.reflection) draw_front_reflection(meeting, next);
    const int count = meeting.beam.interfaces == 0 ? model::BUNDLE_RAYS : 1;
    Beam outgoing = meeting.beam;
    outgoing.weight /= static_cast<float>(count);
    for (int i = 0; i < count; ++i) {
        if (meeting.beam.interfaces == 0) outgoing.number = i;
        draw_walk(meeting, outgoing, next);
    }
}

// By the side of a pane that the beam meets.
void BundleTracer::draw_front_reflection(const Meeting& meeting, Wave& next) const {
    const InterfaceTables& tables = scene_.tables(meeting.hit.material, meeting.eta);
    if (tables.reflection < 0) return;
    Branch reflected{.way = Way::Reflected,
                     .lobe = scene_.lobes().reflected_lobe(tables.reflection, meeting.eta, meeting.roughness,
                                                           meeting.d, meeting.n),
                     .color = meeting.material.reflection_color,
                     .weight = {}};
    reflected.weight = meeting.beam.weight * reflected.lobe.energy * reflected.color;
    branch_off(meeting, reflected, true, next);
}

void BundleTracer::draw_walk(const Meeting& meeting, Beam outgoing, Wave& next) const {
    const SobolPoint point = point_of(outgoing);
    const int first = first_walk_dimension + outgoing.interfaces * walk_dimensions;
    std::array<glm::vec3, PaneWalk::most_steps> u;
    for (int step = 0; step < PaneWalk::most_steps; ++step)
        u[step] = glm::vec3(point.pair(first + 3 * step), point[first + 3 * step + 2]);
    const Material& material = meeting.material;
    const float far_roughness =
        meeting.entering ? inner_roughness_at(material, meeting.hit) : roughness_at(material, meeting.hit);
    const LayeredSurface pane(material, meeting.entering, facet_alpha(roughness_at(material, meeting.hit)),
                              facet_alpha(inner_roughness_at(material, meeting.hit)));
    const glm::mat3 frame = frame_of(meeting.n);
    const auto end = walk_pane(pane, glm::transpose(frame) * -meeting.d, u);
    if (!end) return;
    const bool reflected = end->direction.z > 0.0F;
    if (reflected && !settings_.reflection) return;
    const glm::vec3 d = frame * end->direction;
    Branch branch{.way = reflected ? Way::Reflected : Way::Through,
                  .lobe = last_lobe(meeting, *end, end->is_near ? meeting.roughness : far_roughness),
                  .color = material.color * material.color,
                  .weight = {}};
    if (glm::dot(d, meeting.side(branch)) <= 0.0F) return;
    outgoing.weight *= end->weight * branch.color;
    branch.weight = outgoing.weight;
    light(meeting, branch);
    const float chance = greatest(outgoing.weight) / least_drawn_weight;
    if (chance < 1.0F && meeting.beam.interfaces > 0) {
        if (point[first + walk_dimensions - 1] >= chance) return;
        outgoing.weight /= chance;
    }
    look_between(meeting, branch, d, outgoing);
    next.beams.push_back(outgoing);
    send(meeting, branch, d, next);
}

// Of the interface at which a walk has ended.
model::Lobe BundleTracer::last_lobe(const Meeting& meeting, const PaneWalk& end, float roughness) const {
    const Material& material = meeting.material;
    const glm::vec3 d = frame_of(meeting.n) * -end.o;
    const InterfaceTables& inside = scene_.tables(meeting.hit.material, 1.0F / material.ior);
    return scene_.lobes().refracted_lobe(inside.refraction, inside.eta, roughness, d,
                                         end.is_near ? -meeting.n : meeting.n, model::TIR_NONE);
}

// The last of the next wave's beams, on its way in direction d.
void BundleTracer::send(const Meeting& meeting, const Branch& branch, const glm::vec3& d, Wave& next) const {
    Beam& outgoing = next.beams.back();
    outgoing.exit = branch.way == Way::Reflected ? glm::vec3(0.0F) : -meeting.n;
    outgoing.has_tail = meeting.material.has_tails();
    if (settings_.paths == PathMode::TwoInterface && branch.way == Way::Refracted && !meeting.entering) {
        meeting.radiance += looked_up(outgoing);
        next.beams.pop_back();
        return;
    }
    ++outgoing.interfaces;
    if (branch.way == Way::Refracted) outgoing.media.cross(meeting.hit, meeting.entering);
    next.rays.push_back({beside(meeting.hit, d), d});
}

glm::vec3 BundleTracer::looked_up(const Beam& beam) const {
    const float spread = std::max(beam.divergence.spread(), model::LOBE_MIN_SPREAD);
    if (!beam.has_tail) return beam.weight * looked_up(beam, spread);
    return beam.weight * glm::mix(looked_up(beam, model::widened_spread(spread, model::CORE_WIDTH)),
                                  looked_up(beam, model::widened_spread(spread, model::TAIL_WIDTH)),
                                  model::TAIL_SHARE);
}

glm::vec3 BundleTracer::looked_up(const Beam& beam, float spread) const {
    // Rounder lobes gain nothing from more than one look-up.
    constexpr float least_excess = 0.1F;
    const model::WideLobe lobe = model::wide_lobe(beam.axis, spread, beam.exit);
    if (glm::dot(lobe.axis, lobe.axis) < least_excess * spread)
        return scene_.incoming_radiance(beam.axis, spread);
    std::array<glm::vec3, model::EXIT_TAPS> directions;
    std::array<glm::vec3, model::EXIT_TAPS> radiances;
    for (int i = 0; i < model::EXIT_TAPS; ++i) directions[i] = model::tap_direction(lobe, i);
    scene_.incoming_radiance(directions, std::span(&lobe.spread, 1), radiances);
    return std::accumulate(radiances.begin(), radiances.end(), glm::vec3(0.0F)) /
           static_cast<float>(model::EXIT_TAPS);
}

glm::vec3 BundleTracer::looked_up(Lookups& lookups) const {
    std::array<glm::vec3, LayerLobes::most_lobes> radiances;
    const std::span found(radiances.data(), lookups.count);
    scene_.incoming_radiance({lookups.directions.data(), lookups.count},
                             {lookups.spreads.data(), lookups.count}, found);
    glm::vec3 sum(0.0F);
    for (std::size_t i = 0; i < lookups.count; ++i) sum += lookups.weights[i] * found[i];
    return sum;
}

// The light of a branch that isn't followed.
glm::vec3 BundleTracer::cut_off(const Meeting& meeting, const Branch& branch) const {
    const glm::vec3& d = branch.lobe.direction;
    const float spread = spread_after(meeting, branch);
    if (meeting.is_outside(branch)) return branch.weight * scene_.incoming_radiance(d, spread);
    return model::CUT_SHARE * branch.weight *
           scene_.incoming_radiance(d, std::max(spread, model::CUT_SPREAD));
}

}  // namespace verglas
