// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/bundle_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/tracing/crossing.h"
#include "core/tracing/media.h"

namespace verglas {
namespace {

// How paths branch, as shares of the light that reaches the pixel. Found by measurement (method: 5.5): full
// glass, roughness 0.25 and 0.55, sphere, monkey and bottle; half of each costs a quarter more rays and
// lowers the error of none but the sphere.
constexpr float split_weight = 0.02F;   // reflected and refracted light are both followed above it
constexpr float least_weight = 0.004F;  // the greater of the two is followed above it

// Light that is followed no further inside the glass leaves it after more interfaces, wherever to: it is
// taken from nearly everywhere, less what these keep. Both measured on the same scenes, where they are flat.
constexpr float cut_spread = 0.8F;
constexpr float cut_share = 0.7F;

// A narrower front lobe is one ray: its four would land in the same pixels of anything.
constexpr float least_bundle_spread = 1e-6F;

// Bundles of neighbouring pixels are turned against each other, in a pattern of 2 x 2 pixels, so that their
// average (surface_average.h) has sixteen rays.
glm::vec2 turned(glm::vec2 azimuth, glm::ivec2 pixel) {
    constexpr std::array<int, 4> quarter_steps = {0, 2, 3, 1};
    const int step = quarter_steps[(pixel.x & 1) + 2 * (pixel.y & 1)];
    const float angle = glm::half_pi<float>() * 0.25F * static_cast<float>(step);
    const glm::vec2 turn(std::cos(angle), std::sin(angle));
    return {azimuth.x * turn.x - azimuth.y * turn.y, azimuth.x * turn.y + azimuth.y * turn.x};
}

float greatest(const glm::vec3& v) { return std::max({v.x, v.y, v.z}); }

// 1 - R of two lobes one after the other, whose mean lengths R multiply.
float joined_spread(float a, float b) { return a + b - a * b; }

// The direction, bent to leave to the side of the triangle that a normal shows to: interpolated normals may
// send it to the other.
glm::vec3 on_side(const glm::vec3& d, const glm::vec3& side) {
    constexpr float least_cosine = 1e-3F;
    const float cosine = glm::dot(d, side);
    return cosine >= least_cosine ? d : glm::normalize(d + (least_cosine - cosine) * side);
}

}  // namespace

// One ray and the lobe about it, on its way to a pixel.
struct BundleTracer::Beam {
    glm::vec3 weight;     // of the radiance that it brings
    float spread = 0.0F;  // of the lobe, without the part that the bundle's four rays stand for
    glm::ivec2 pixel;
    int interfaces = 0;  // crossed
    MediumStack media;
};

// What an interface makes of a beam.
struct BundleTracer::Branch {
    model::Lobe lobe;
    glm::vec3 weight;  // the beam's and the lobe's
    bool reflected;
    bool entering;  // whether the beam was

    bool stays_inside() const { return reflected != entering; }
};

// Beams that have crossed the same number of interfaces, and their rays.
struct BundleTracer::Wave {
    std::vector<Beam> beams;
    std::vector<Ray> rays;

    void clear() {
        beams.clear();
        rays.clear();
    }
    void add(const Beam& beam, const Ray& ray) {
        beams.push_back(beam);
        rays.push_back(ray);
    }
};

BundleTracer::BundleTracer(const TracedScene& scene, const Settings& settings)
    : scene_(scene), settings_(settings), camera_(scene.scene().camera, settings.size) {}

void BundleTracer::trace(const Rect& tile, TracedPicture& picture) const {
    thread_local Wave wave;
    thread_local Wave next;
    thread_local std::vector<Hit> hits;
    wave.clear();
    start(tile, picture, wave);
    while (!wave.rays.empty()) {
        hits.resize(wave.rays.size());
        scene_.rays().intersect(wave.rays, hits);
        next.clear();
        for (std::size_t i = 0; i < hits.size(); ++i)
            meet(wave.beams[i], wave.rays[i], hits[i], picture, next);
        std::swap(wave, next);
    }
}

// A ray through the centre of each pixel.
void BundleTracer::start(const Rect& tile, const TracedPicture&, Wave& wave) const {
    Beam beam{.weight = glm::vec3(1.0F), .pixel = {}, .media = {}};
    for (beam.pixel.y = tile.begin.y; beam.pixel.y < tile.end.y; ++beam.pixel.y)
        for (beam.pixel.x = tile.begin.x; beam.pixel.x < tile.end.x; ++beam.pixel.x)
            wave.add(beam, camera_.through(glm::vec2(beam.pixel) + 0.5F));
}

void BundleTracer::meet(const Beam& incoming, const Ray& ray, const Hit& hit, TracedPicture& picture,
                        Wave& next) const {
    const std::size_t place = picture.place(incoming.pixel.x, incoming.pixel.y);
    glm::vec3& radiance = picture.radiance[place];
    if (hit.object < 0) {
        if (incoming.interfaces > 0 || !settings_.transparent)
            radiance += incoming.weight *
                        scene_.incoming_radiance(ray.d, std::max(incoming.spread, model::LOBE_MIN_SPREAD));
        return;
    }
    const Scene& scene = scene_.scene();
    const Material& material = scene.materials[hit.material];
    const bool entering = is_entering(hit, ray.d);
    const glm::vec3 n = facing_normal(hit, ray.d);
    const float roughness = roughness_at(material, hit);
    if (incoming.interfaces == 0 && picture.surfaces[place].object < 0)
        picture.surfaces[place] = {hit.normal, camera_.depth(hit.position), hit.object,
                                   model::alpha_from_roughness(roughness)};

    Beam beam = incoming;
    beam.weight *= beam.media.transmittance(scene, hit, entering);
    const MediumStack::Interface interface = beam.media.interface(scene, hit, entering);
    if (!interface.bends()) {
        if (interface.is_real) beam.weight *= material.color;
        beam.media.cross(hit, entering);
        if (++beam.interfaces <= settings_.max_interfaces) next.add(beam, {beside(hit, ray.d), ray.d});
        return;
    }

    const InterfaceTables& tables = scene_.tables(hit.material, interface.eta);
    const bool reflects = settings_.reflection && tables.reflection >= 0;
    Branch refracted{
        scene_.lobes().refracted_lobe(tables.refraction, interface.eta, roughness, ray.d, n, model::TIR_NONE),
        {},
        false,
        entering};
    refracted.weight = beam.weight * refracted.lobe.energy * material.color;
    Branch reflected{{}, glm::vec3(0.0F), true, entering};
    if (reflects) {
        reflected.lobe = scene_.lobes().reflected_lobe(tables.reflection, interface.eta, roughness, ray.d, n);
        reflected.weight = beam.weight * reflected.lobe.energy * material.reflection_color;
    }

    const bool goes_on = beam.interfaces < settings_.max_interfaces;
    const float greater = std::max(greatest(refracted.weight), greatest(reflected.weight));
    for (const Branch* branch : {&refracted, &reflected}) {
        const float weight = greatest(branch->weight);
        if (weight <= 0.0F) continue;
        const bool followed = weight >= split_weight || (weight == greater && weight >= least_weight);
        if (!goes_on || !followed)
            radiance += cut_off(beam, *branch);
        else if (beam.interfaces == 0 && !branch->reflected)
            split_front(beam, hit, n, *branch, next);
        else
            follow(beam, hit, n, *branch, next);
    }
}

// Along the lobe's mean direction.
void BundleTracer::follow(const Beam& beam, const Hit& hit, const glm::vec3&, const Branch& branch,
                          Wave& next) const {
    Beam outgoing = beam;
    outgoing.weight = branch.weight;
    outgoing.spread = joined_spread(beam.spread, branch.lobe.spread);
    ++outgoing.interfaces;
    if (!branch.reflected) outgoing.media.cross(hit, branch.entering);
    const glm::vec3 side = branch.stays_inside() ? -hit.geometric_normal : hit.geometric_normal;
    const glm::vec3 d = on_side(branch.lobe.direction, side);
    next.add(outgoing, {beside(hit, d), d});
}

// Four rays in place of the lobe.
void BundleTracer::split_front(const Beam& beam, const Hit& hit, const glm::vec3& n, const Branch& branch,
                               Wave& next) const {
    if (branch.lobe.spread < least_bundle_spread) return follow(beam, hit, n, branch, next);
    Beam outgoing = beam;
    outgoing.weight = branch.weight / static_cast<float>(model::BUNDLE_RAYS);
    ++outgoing.interfaces;
    outgoing.media.cross(hit, branch.entering);
    const glm::vec3 side = branch.stays_inside() ? -hit.geometric_normal : hit.geometric_normal;
    for (int i = 0; i < model::BUNDLE_RAYS; ++i) {
        const glm::vec3 d =
            on_side(model::bundle_ray(branch.lobe, n, turned(model::bundle_azimuth(i), beam.pixel)), side);
        next.add(outgoing, {beside(hit, d), d});
    }
}

// The light of a branch that isn't followed.
glm::vec3 BundleTracer::cut_off(const Beam& beam, const Branch& branch) const {
    const float spread = joined_spread(beam.spread, branch.lobe.spread);
    if (!branch.stays_inside())
        return branch.weight * scene_.incoming_radiance(branch.lobe.direction, spread);
    return cut_share * branch.weight *
           scene_.incoming_radiance(branch.lobe.direction, std::max(spread, cut_spread));
}

}  // namespace verglas
