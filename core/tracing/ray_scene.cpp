// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/ray_scene.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <map>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "core/error.h"
#include "core/material/model.h"
#include "core/tracing/refit_cost.h"

namespace verglas {
namespace {

// Beyond this refit_cost() a tree is built anew, which takes twenty times as long as to refit it.
constexpr float most_refit_cost = 1.3F;

// Embree reads vertices 16 bytes at a time: the last one must be followed by 4 more bytes, so they are
// copied.
void set_new_vertices(RTCGeometry geometry, const Mesh& mesh) {
    const std::vector<glm::vec3>& positions = mesh.positions();
    auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), positions.size()));
    if (vertices != nullptr) std::copy(positions.begin(), positions.end(), vertices);
}

void update_vertices(RTCGeometry geometry, const Mesh& mesh) {
    auto* vertices = static_cast<glm::vec3*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
    std::copy(mesh.positions().begin(), mesh.positions().end(), vertices);
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
}

void share_indices(RTCGeometry geometry, const Mesh& mesh) {
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices().data(), 0,
                               3 * sizeof(std::uint32_t), mesh.triangle_count());
}

// Embree 3 and 4 differ in how options come along with a query.
#if RTC_VERSION_MAJOR >= 4
using Options = RTCIntersectArguments;

Options make_options() {
    Options options;
    rtcInitIntersectArguments(&options);
    return options;
}

void intersect_one(RTCScene scene, RTCRayHit& query) { rtcIntersect1(scene, &query, nullptr); }

void occlude_one(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, nullptr); }

template <typename Function, typename Packet>
void intersect_packet(Function function, const int* valid, RTCScene scene, Packet& packet, Options& options) {
    function(valid, scene, &packet, &options);
}
#else
using Options = RTCIntersectContext;

Options make_options() {
    Options options;
    rtcInitIntersectContext(&options);
    return options;
}

void intersect_one(RTCScene scene, RTCRayHit& query) {
    Options options = make_options();
    rtcIntersect1(scene, &options, &query);
}

void occlude_one(RTCScene scene, RTCRay& ray) {
    Options options = make_options();
    rtcOccluded1(scene, &options, &ray);
}

template <typename Function, typename Packet>
void intersect_packet(Function function, const int* valid, RTCScene scene, Packet& packet, Options& options) {
    function(valid, scene, &options, &packet);
}
#endif

RTCRay make_ray(const glm::vec3& origin, const glm::vec3& d) {
    RTCRay ray{};
    ray.org_x = origin.x;
    ray.org_y = origin.y;
    ray.org_z = origin.z;
    ray.dir_x = d.x;
    ray.dir_y = d.y;
    ray.dir_z = d.z;
    ray.tnear = 0.0F;
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = ~0U;
    return ray;
}

// `width` rays side by side.
template <int width>
struct Packet;

template <>
struct Packet<4> {
    RTCRayHit4 lanes;
    static constexpr auto intersect = rtcIntersect4;
};

template <>
struct Packet<8> {
    RTCRayHit8 lanes;
    static constexpr auto intersect = rtcIntersect8;
};

template <>
struct Packet<16> {
    RTCRayHit16 lanes;
    static constexpr auto intersect = rtcIntersect16;
};

// What is the same of all rays.
template <int width>
void prepare(Packet<width>& packet) {
    auto& ray = packet.lanes.ray;
    for (int i = 0; i < width; ++i) {
        ray.tnear[i] = ray.time[i] = 0.0F;
        ray.mask[i] = ~0U;
        ray.id[i] = ray.flags[i] = 0;
    }
}

template <typename Lanes>
void set_lane(Lanes& lanes, int i, const Ray& ray) {
    lanes.ray.org_x[i] = ray.origin.x;
    lanes.ray.org_y[i] = ray.origin.y;
    lanes.ray.org_z[i] = ray.origin.z;
    lanes.ray.dir_x[i] = ray.d.x;
    lanes.ray.dir_y[i] = ray.d.y;
    lanes.ray.dir_z[i] = ray.d.z;
    lanes.ray.tfar[i] = std::numeric_limits<float>::infinity();
    lanes.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    lanes.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
}

// Embree's debug checks, which distributions leave on, end the process over rays that overflow when they are
// squared, in world space or in an object's: 1.8e19 and beyond, with NaN. What comes near is left out.
constexpr float most_coordinate = 1e8F;
constexpr float most_inverse_scale = 1e9F;

inline bool is_traceable(const glm::vec3& origin, const glm::vec3& d) {
    const glm::vec3 p = glm::abs(origin);
    return p.x <= most_coordinate && p.y <= most_coordinate && p.z <= most_coordinate &&
           glm::dot(d, d) <= 4.0F;
}

// Objects that are scaled to nothing aren't.
bool is_traceable(const glm::mat4& matrix) {
    const glm::mat3 inverse = glm::inverse(glm::mat3(matrix));
    for (int column = 0; column < 3; ++column) {
        if (std::abs(matrix[3][column]) > most_coordinate) return false;
        for (int row = 0; row < 3; ++row) {
            if (!(std::abs(inverse[column][row]) <= most_inverse_scale)) return false;
        }
    }
    return true;
}

int native_width(RTCDevice device) {
    if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) return 16;
    return rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0 ? 8 : 4;
}

// A point of a triangle. u, v: barycentric.
struct TrianglePoint {
    const std::uint32_t* corner;
    float u;
    float v;

    // Of values of the mesh's vertices.
    template <typename Value>
    Value mix(const std::vector<Value>& values) const {
        return (1.0F - u - v) * values[corner[0]] + u * values[corner[1]] + v * values[corner[2]];
    }

    // From the first corner to another.
    template <typename Value>
    Value edge(const std::vector<Value>& values, int end) const {
        return values[corner[end]] - values[corner[0]];
    }
};

// Whether a tree of one fits the other when its boxes are made anew.
bool same_triangles(const Mesh& a, const Mesh& b) {
    return a.name() == b.name() && a.positions().size() == b.positions().size() && a.indices() == b.indices();
}

}  // namespace

void RayScene::Release::operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
void RayScene::Release::operator()(RTCGeometryTy* geometry) const { rtcReleaseGeometry(geometry); }
void RayScene::Release::operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }

RayScene::RayScene() : device_(rtcNewDevice(nullptr)) {
    if (!device_) throw Error("Embree can't be started on this processor.");
    // Embree keeps errors by thread; it builds on many.
    rtcSetDeviceErrorFunction(
        device_.get(),
        [](void* error, RTCError code, const char*) { static_cast<std::atomic<int>*>(error)->store(code); },
        &error_);
    packet_width_ = native_width(device_.get());
    build_top();
}

RayScene::RayScene(const Scene& scene) : RayScene() { update(scene); }

void RayScene::update(const Scene& scene) {
    const bool new_trees = update_trees(scene);
    std::unordered_map<const Mesh*, RTCScene> trees;
    for (const Tree& tree : trees_) trees[tree.mesh.get()] = tree.scene.get();
    std::vector<Placed> objects;
    for (const Object& object : scene.objects) {
        if (object.mesh->indices().empty() || !is_traceable(object.matrix)) continue;
        objects.push_back({object.mesh, trees.at(object.mesh.get()), object.matrix,
                           glm::transpose(glm::inverse(glm::mat3(object.matrix))), object.materials,
                           static_cast<int>(&object - scene.objects.data()),
                           static_cast<std::uint32_t>(objects.size())});
    }
    reliefs_.clear();
    if (std::any_of(scene.materials.begin(), scene.materials.end(),
                    [](const Material& material) { return !material.relief.empty(); })) {
        for (const Material& material : scene.materials) reliefs_.push_back(material.relief);
    }
    const bool moved = !std::equal(
        objects.begin(), objects.end(), objects_.begin(), objects_.end(),
        [](const Placed& a, const Placed& b) { return a.tree == b.tree && a.matrix == b.matrix; });
    objects_ = std::move(objects);
    if (new_trees || moved) build_top();
    if (const int error = error_.exchange(RTC_ERROR_NONE); error != RTC_ERROR_NONE) {
        trees_.clear();
        objects_.clear();
        build_top();
        throw Error(error == RTC_ERROR_OUT_OF_MEMORY
                        ? "There isn't enough memory to trace rays through the scene."
                        : "Embree failed with its error " + std::to_string(error) + ".");
    }
}

// Whether any tree is new or deformed.
bool RayScene::update_trees(const Scene& scene) {
    std::unordered_set<const Mesh*> old;
    std::unordered_set<const Mesh*> wanted;
    for (const Object& object : scene.objects) wanted.insert(object.mesh.get());
    std::multimap<std::string_view, Tree> gone;  // by name; the same names in their order
    std::vector<Tree> trees;
    for (Tree& tree : std::exchange(trees_, {})) {
        const Mesh& mesh = *tree.mesh;
        old.insert(&mesh);
        if (wanted.count(&mesh) > 0)
            trees.push_back(std::move(tree));
        else
            gone.emplace(mesh.name(), std::move(tree));
    }
    const std::size_t kept = trees.size();
    for (const Object& object : scene.objects) {
        if (object.mesh->indices().empty() || !old.insert(object.mesh.get()).second) continue;
        const auto [first, last] = gone.equal_range(object.mesh->name());
        const auto same = std::find_if(
            first, last, [&](const auto& entry) { return same_triangles(*entry.second.mesh, *object.mesh); });
        if (same != last) {
            trees.push_back(std::move(same->second));
            gone.erase(same);
        } else {
            trees.emplace_back();
        }
        trees.back().mesh = object.mesh;
    }
    tbb::parallel_for(kept, trees.size(), [&](std::size_t i) {
        if (trees[i].scene)
            deform(trees[i]);
        else
            build(trees[i]);
    });
    const bool changed = trees.size() > kept;
    trees_ = std::move(trees);
    return changed;
}

void RayScene::build(Tree& tree) const {
    tree.built = tree.mesh;
    tree.scene.reset(rtcNewScene(device_.get()));
    tree.geometry.reset(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
    RTCGeometry geometry = tree.geometry.get();
    set_new_vertices(geometry, *tree.mesh);
    share_indices(geometry, *tree.mesh);
    // The first build is a full one, by the surface area heuristic. Only scenes of these flags refit.
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    rtcSetSceneBuildQuality(tree.scene.get(), RTC_BUILD_QUALITY_LOW);
    rtcSetSceneFlags(tree.scene.get(),
                     static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree.scene.get(), geometry);
    rtcCommitScene(tree.scene.get());
}

void RayScene::deform(Tree& tree) const {
    RTCGeometry geometry = tree.geometry.get();
    update_vertices(geometry, *tree.mesh);
    if (refit_cost(*tree.built, *tree.mesh) > most_refit_cost) {
        tree.built = tree.mesh;
        share_indices(geometry, *tree.mesh);  // Embree takes them for others and builds
    }
    rtcCommitGeometry(geometry);
    rtcCommitScene(tree.scene.get());
}

void RayScene::build_top() {
    top_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(top_.get(), RTC_SCENE_FLAG_ROBUST);
    for (unsigned i = 0; i < objects_.size(); ++i) {
        const GeometryPointer instance(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(instance.get(), objects_[i].tree);
        rtcSetGeometryTransform(instance.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                                glm::value_ptr(objects_[i].matrix));
        rtcCommitGeometry(instance.get());
        rtcAttachGeometryByID(top_.get(), instance.get(), i);
    }
    rtcCommitScene(top_.get());
}

int RayScene::Placed::material_of(std::uint32_t triangle) const {
    const std::vector<MeshPart>& parts = mesh->parts();
    if (parts.size() == 1) return material_of(parts.front());
    const auto after =
        std::upper_bound(parts.begin(), parts.end(), 3 * triangle,
                         [](std::uint32_t corner, const MeshPart& part) { return corner < part.first; });
    return material_of(*std::prev(after));
}

int RayScene::Placed::material_of(const MeshPart& part) const {
    return materials[std::min(part.slot, static_cast<int>(materials.size()) - 1)];
}

// u, v: barycentric. outward: the triangle's normal in object space, of any length.
Hit RayScene::Placed::hit(float t, std::uint32_t triangle, float u, float v, const glm::vec3& outward) const {
    const TrianglePoint point{&mesh->indices()[std::size_t{3} * triangle], u, v};
    Hit hit;
    hit.t = t;
    // More precise than origin + t d.
    hit.position = glm::vec3(matrix * glm::vec4(point.mix(mesh->positions()), 1.0F));
    hit.geometric_normal = glm::normalize(normal_matrix * outward);
    hit.normal = glm::normalize(normal_matrix * point.mix(mesh->normals()));
    if (!mesh->uvs().empty()) hit.uv = point.mix(mesh->uvs());
    hit.material = material_of(triangle);
    hit.object = index;
    hit.instance = instance;
    hit.triangle = triangle;
    return hit;
}

// Normals are linear in positions over the triangle. Trace and determinant of that map are the sum and the
// product of the principal curvatures; its matrix in the basis of two edges is that of the fundamental forms,
// second by first.
Curvature RayScene::Placed::curvature(std::uint32_t triangle) const {
    constexpr double least_sine2 = 1e-6;  // of the angle between two edges
    const std::uint32_t* corner = &mesh->indices()[std::size_t{3} * triangle];
    const glm::mat3 linear(matrix);
    const auto edge = [&](int i) {
        return glm::dvec3(linear * (mesh->positions()[corner[i]] - mesh->positions()[corner[0]]));
    };
    const auto normal = [&](int i) {
        return glm::dvec3(glm::normalize(normal_matrix * mesh->normals()[corner[i]]));
    };
    const glm::dvec3 p_u = edge(1);
    const glm::dvec3 p_v = edge(2);
    const glm::dvec3 n_u = normal(1) - normal(0);
    const glm::dvec3 n_v = normal(2) - normal(0);
    const double E = glm::dot(p_u, p_u);
    const double F = glm::dot(p_u, p_v);
    const double G = glm::dot(p_v, p_v);
    const double determinant = E * G - F * F;
    if (!(determinant > least_sine2 * E * G)) return {};
    const double e = glm::dot(n_u, p_u);
    const double f_u = glm::dot(n_u, p_v);
    const double f_v = glm::dot(n_v, p_u);
    const double g = glm::dot(n_v, p_v);
    const double mean = 0.5 * (G * e - F * (f_u + f_v) + E * g) / determinant;
    const double gaussian = (e * g - f_u * f_v) / determinant;
    return {static_cast<float>(mean), static_cast<float>(std::sqrt(std::max(mean * mean - gaussian, 0.0)))};
}

// n: interpolated, unit, world space. u, v: barycentric.
glm::vec3 RayScene::Placed::bent_normal(const glm::vec3& n, const Relief& relief, std::uint32_t triangle,
                                        float u, float v) const {
    const TrianglePoint point{&mesh->indices()[std::size_t{3} * triangle], u, v};
    const ReliefCoordinates& places = mesh->relief();
    const NormalMap& map = relief.normals;
    const BumpMap& bump = relief.bump;
    glm::vec3 bent = n;
    if (map.texture && places.has(map)) {
        glm::mat3 axes = map.space == NormalSpace::World ? glm::mat3(1.0F) : normal_matrix;
        if (map.space == NormalSpace::Tangent)
            axes *= model::tangent_frame(point.mix(mesh->normals()), point.mix(places.tangents));
        const glm::vec3 color = map.texture->sample(point.mix(places.normal_uvs));
        bent = model::mapped_normal(bent, axes, color, map.steepness, map.strength);
    }
    if (bump.height && places.has(bump)) {
        const glm::mat3 linear(matrix);
        const glm::vec2 rise = bump.distance * slope(*bump.height, point.mix(places.height_uvs));
        bent = model::bumped_normal(bent, linear * point.edge(mesh->positions(), 1),
                                    linear * point.edge(mesh->positions(), 2),
                                    glm::dot(rise, point.edge(places.height_uvs, 1)),
                                    glm::dot(rise, point.edge(places.height_uvs, 2)), bump.strength);
    }
    return bent;
}

// d: the ray's direction.
Hit RayScene::hit(unsigned instance, const glm::vec3& d, float t, std::uint32_t triangle, float u, float v,
                  const glm::vec3& outward) const {
    const Placed& object = objects_[instance];
    Hit hit = object.hit(t, triangle, u, v, outward);
    if (reliefs_.empty() || reliefs_[hit.material].empty()) return hit;
    const glm::vec3 bent = object.bent_normal(hit.normal, reliefs_[hit.material], triangle, u, v);
    const float side = glm::dot(d, hit.geometric_normal) < 0.0F ? 1.0F : -1.0F;
    hit.normal = side * model::mirroring_normal(side * bent, side * hit.geometric_normal, -d);
    return hit;
}

std::optional<Hit> RayScene::intersect(const glm::vec3& origin, const glm::vec3& d) const {
    if (!is_traceable(origin, d)) return std::nullopt;
    RTCRayHit query{};
    query.ray = make_ray(origin, d);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect_one(top_.get(), query);
    const RTCHit& found = query.hit;
    if (found.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    return hit(found.instID[0], d, query.ray.tfar, found.primID, found.u, found.v,
               {found.Ng_x, found.Ng_y, found.Ng_z});
}

void RayScene::intersect(std::span<const Ray> rays, std::span<Hit> hits) const {
    switch (packet_width_) {
        case 16:
            return intersect_packets<16>(rays, hits);
        case 8:
            return intersect_packets<8>(rays, hits);
        default:
            return intersect_packets<4>(rays, hits);
    }
}

template <int width>
void RayScene::intersect_packets(std::span<const Ray> rays, std::span<Hit> hits) const {
    Options options = make_options();
    Packet<width> packet;
    prepare(packet);
    alignas(64) int valid[width];
    for (std::size_t first = 0; first < rays.size(); first += width) {
        const int count = static_cast<int>(std::min<std::size_t>(width, rays.size() - first));
        for (int i = 0; i < width; ++i) {
            const Ray& ray = rays[first + std::min(i, count - 1)];
            set_lane(packet.lanes, i, ray);
            valid[i] = i < count && is_traceable(ray.origin, ray.d) ? -1 : 0;
        }
        intersect_packet(Packet<width>::intersect, valid, top_.get(), packet.lanes, options);
        const auto& found = packet.lanes.hit;
        for (int i = 0; i < count; ++i) {
            const bool met = found.geomID[i] != RTC_INVALID_GEOMETRY_ID;
            hits[first + i] =
                met ? hit(found.instID[0][i], rays[first + i].d, packet.lanes.ray.tfar[i], found.primID[i],
                          found.u[i], found.v[i], {found.Ng_x[i], found.Ng_y[i], found.Ng_z[i]})
                    : Hit::none();
        }
    }
}

bool RayScene::escapes(const glm::vec3& origin, const glm::vec3& d, float distance) const {
    if (!is_traceable(origin, d)) return true;
    RTCRay ray = make_ray(origin, d);
    ray.tfar = distance;
    occlude_one(top_.get(), ray);
    return ray.tfar >= 0.0F;
}

}  // namespace verglas
