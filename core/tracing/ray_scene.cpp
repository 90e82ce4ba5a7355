// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/ray_scene.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <unordered_map>

#include "core/error.h"

namespace verglas {
namespace {

// Embree reads vertices 16 bytes at a time: the last one must be followed by 4 more bytes, so they are
// copied.
glm::vec3* new_vertices(RTCGeometry geometry, std::size_t count) {
    return static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                           RTC_FORMAT_FLOAT3, sizeof(glm::vec3), count));
}

void share_indices(RTCGeometry geometry, const Mesh& mesh) {
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices().data(), 0,
                               3 * sizeof(std::uint32_t), mesh.triangle_count());
}

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
    build_top();
}

RayScene::RayScene(const Scene& scene) : RayScene() { update(scene); }

void RayScene::update(const Scene& scene) {
    bool changed = update_trees(scene);
    std::unordered_map<const Mesh*, RTCScene> trees;
    for (const Tree& tree : trees_) trees[tree.mesh.get()] = tree.scene.get();
    std::vector<Placed> objects;
    for (const Object& object : scene.objects) {
        if (object.mesh->indices().empty()) continue;
        objects.push_back({object.mesh, trees.at(object.mesh.get()), object.matrix,
                           glm::transpose(glm::inverse(glm::mat3(object.matrix))), object.materials,
                           static_cast<int>(&object - scene.objects.data())});
    }
    changed = changed || !std::equal(objects.begin(), objects.end(), objects_.begin(), objects_.end(),
                                     [](const Placed& a, const Placed& b) {
                                         return a.tree == b.tree && a.matrix == b.matrix;
                                     });
    objects_ = std::move(objects);
    if (changed) build_top();
    check();
}

// Whether any tree was built or refit.
bool RayScene::update_trees(const Scene& scene) {
    std::vector<std::shared_ptr<const Mesh>> unknown;
    std::unordered_map<const Mesh*, bool> kept;  // the scene's meshes, and whether they had a tree before
    for (const Object& object : scene.objects) {
        if (!object.mesh->indices().empty()) kept[object.mesh.get()] = false;
    }
    std::vector<Tree> left;
    std::vector<Tree> trees;
    for (Tree& tree : trees_) {
        const auto found = kept.find(tree.mesh.get());
        if (found != kept.end()) found->second = true;
        (found != kept.end() ? trees : left).push_back(std::move(tree));
    }
    bool changed = false;
    for (const Object& object : scene.objects) {
        const auto found = kept.find(object.mesh.get());
        if (found == kept.end() || found->second) continue;
        found->second = changed = true;
        const auto same = std::find_if(left.begin(), left.end(), [&](const Tree& tree) {
            return same_triangles(*tree.mesh, *object.mesh);
        });
        if (same == left.end()) {
            trees.push_back(build(object.mesh));
        } else {
            trees.push_back(std::move(*same));
            left.erase(same);
            refit(trees.back(), object.mesh);
        }
    }
    trees_ = std::move(trees);
    return changed;
}

RayScene::Tree RayScene::build(std::shared_ptr<const Mesh> mesh) const {
    Tree tree{std::move(mesh), ScenePointer(rtcNewScene(device_.get())),
              GeometryPointer(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE))};
    RTCGeometry geometry = tree.geometry.get();
    const std::vector<glm::vec3>& positions = tree.mesh->positions();
    std::copy(positions.begin(), positions.end(), new_vertices(geometry, positions.size()));
    share_indices(geometry, *tree.mesh);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(tree.scene.get(), geometry);
    rtcSetSceneFlags(tree.scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(tree.scene.get());
    return tree;
}

void RayScene::refit(Tree& tree, std::shared_ptr<const Mesh> mesh) const {
    RTCGeometry geometry = tree.geometry.get();
    auto* vertices = static_cast<glm::vec3*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0));
    std::copy(mesh->positions().begin(), mesh->positions().end(), vertices);
    share_indices(geometry, *mesh);
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(geometry);
    rtcCommitScene(tree.scene.get());
    tree.mesh = std::move(mesh);
}

void RayScene::build_top() {
    top_.reset(rtcNewScene(device_.get()));
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

void RayScene::check() const {
    const RTCError error = rtcGetDeviceError(device_.get());
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw Error("There isn't enough memory for the scene's rays.");
    if (error != RTC_ERROR_NONE) throw Error("Embree failed with error " + std::to_string(error) + ".");
}

int RayScene::material_of(const Placed& object, std::uint32_t triangle) const {
    const std::vector<MeshPart>& parts = object.mesh->parts();
    const auto after =
        std::upper_bound(parts.begin(), parts.end(), 3 * triangle,
                         [](std::uint32_t index, const MeshPart& part) { return index < part.first; });
    const int slot = std::prev(after)->slot;
    return object.materials[std::min(slot, static_cast<int>(object.materials.size()) - 1)];
}

std::optional<Hit> RayScene::intersect(const glm::vec3& origin, const glm::vec3& d) const {
    RTCRayHit query{};
    query.ray = make_ray(origin, d);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(top_.get(), &query);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(top_.get(), &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
    const Placed& object = objects_[query.hit.instID[0]];
    const std::uint32_t* corner = &object.mesh->indices()[std::size_t{3} * query.hit.primID];
    const float u = query.hit.u;
    const float v = query.hit.v;
    const auto mix = [&](const auto& values) {
        return (1.0F - u - v) * values[corner[0]] + u * values[corner[1]] + v * values[corner[2]];
    };
    const glm::vec3 outward(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
    Hit hit;
    hit.t = query.ray.tfar;
    // More precise than origin + t d.
    hit.position = glm::vec3(object.matrix * glm::vec4(mix(object.mesh->positions()), 1.0F));
    hit.geometric_normal = glm::normalize(object.normal_matrix * outward);
    hit.normal = glm::normalize(object.normal_matrix * mix(object.mesh->normals()));
    if (!object.mesh->uvs().empty()) hit.uv = mix(object.mesh->uvs());
    hit.material = material_of(object, query.hit.primID);
    hit.object = object.index;
    return hit;
}

void RayScene::intersect(std::span<const Ray> rays, std::span<Hit> hits) const {
    for (std::size_t i = 0; i < rays.size(); ++i)
        hits[i] = intersect(rays[i].origin, rays[i].d).value_or(Hit::none());
}

bool RayScene::escapes(const glm::vec3& origin, const glm::vec3& d) const {
    RTCRay ray = make_ray(origin, d);
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(top_.get(), &ray);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(top_.get(), &context, &ray);
#endif
    return ray.tfar >= 0.0F;
}

}  // namespace verglas
