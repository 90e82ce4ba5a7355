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
void set_mesh(RTCGeometry geometry, const Mesh& mesh) {
    auto* vertices = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), mesh.positions().size()));
    std::copy(mesh.positions().begin(), mesh.positions().end(), vertices);
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

}  // namespace

void RayScene::Release::operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
void RayScene::Release::operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }

RayScene::RayScene(const Scene& scene) : device_(rtcNewDevice(nullptr)), top_(nullptr) {
    if (!device_) throw Error("Embree can't be started on this processor.");
    top_.reset(rtcNewScene(device_.get()));
    std::unordered_map<const Mesh*, RTCScene> known;
    for (const Object& object : scene.objects) {
        if (object.mesh->indices().empty()) continue;
        RTCScene& mesh_scene = known[object.mesh.get()];
        if (mesh_scene == nullptr) {
            mesh_scene = meshes_.emplace_back(rtcNewScene(device_.get())).get();
            rtcSetSceneFlags(mesh_scene, RTC_SCENE_FLAG_ROBUST);
            RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
            set_mesh(geometry, *object.mesh);
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(mesh_scene, geometry);
            rtcReleaseGeometry(geometry);
            rtcCommitScene(mesh_scene);
        }
        RTCGeometry instance = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(instance, mesh_scene);
        rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, glm::value_ptr(object.matrix));
        rtcCommitGeometry(instance);
        rtcAttachGeometryByID(top_.get(), instance, static_cast<unsigned>(objects_.size()));
        rtcReleaseGeometry(instance);
        const glm::mat3 linear(object.matrix);
        objects_.push_back({object.mesh, object.matrix, glm::transpose(glm::inverse(linear)),
                            object.materials, static_cast<int>(&object - scene.objects.data())});
    }
    rtcCommitScene(top_.get());
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
