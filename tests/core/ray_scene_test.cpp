// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/ray_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "core/tracing/refit_cost.h"

namespace verglas {
namespace {

using glm::mat4;
using glm::uvec3;
using glm::vec2;
using glm::vec3;

using MeshPointer = std::shared_ptr<const Mesh>;

// A ball of radius 1 + 0.3 sin(5 z + phase), its triangles in slots by longitude. Uv: longitude and latitude.
MeshPointer ball(const std::string& name, float phase = 0.0F, int slots = 1, int rings = 12) {
    const int around = 2 * rings;
    std::vector<vec3> positions;
    std::vector<vec2> uvs;
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j <= around; ++j) {
            const vec2 uv(float(j) / float(around), float(i) / float(rings));
            const float theta = glm::pi<float>() * uv.y;
            const float phi = glm::two_pi<float>() * uv.x;
            const vec3 p(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            positions.push_back((1.0F + 0.3F * std::sin(5.0F * p.z + phase)) * p);
            uvs.push_back(uv);
        }
    }
    std::vector<uvec3> triangles;
    std::vector<std::uint16_t> slot;
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < around; ++j) {
            const unsigned a = i * (around + 1) + j;
            const unsigned b = a + around + 1;
            if (i + 1 < rings) triangles.emplace_back(a, b, b + 1);
            if (i > 0) triangles.emplace_back(a, b + 1, a + 1);
            slot.resize(triangles.size(), static_cast<std::uint16_t>(j % slots));
        }
    }
    return std::make_shared<const Mesh>(name, positions, positions, triangles, slot, uvs);
}

mat4 at(const vec3& position) { return glm::translate(mat4(1.0F), position); }

Scene scene_of(std::vector<Object> objects) {
    Scene scene;
    scene.materials.resize(8);
    scene.objects = std::move(objects);
    return scene;
}

// From around the origin to around the origin: into a space of a few units.
std::vector<Ray> random_rays(int count, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    const auto point = [&] { return vec3(unit(random), unit(random), unit(random)); };
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.origin = 6.0F * point();
        ray.d = glm::normalize(3.0F * point() - ray.origin);
    }
    return rays;
}

// Every triangle is tried, in double precision (Moeller and Trumbore 1997).
struct Truth {
    double t = std::numeric_limits<double>::infinity();
    int object = -1;
    int material = -1;
    glm::dvec3 geometric_normal{0.0};
    glm::dvec3 normal{0.0};
    glm::dvec2 uv{0.0};
};

Truth truth_of(const Scene& scene, const Ray& ray) {
    Truth nearest;
    for (int o = 0; o < int(scene.objects.size()); ++o) {
        const Object& object = scene.objects[o];
        const Mesh& mesh = *object.mesh;
        const glm::dmat4 matrix(object.matrix);
        const glm::dmat3 normal_matrix = glm::transpose(glm::inverse(glm::dmat3(matrix)));
        for (const MeshPart& part : mesh.parts()) {
            for (std::uint32_t i = part.first; i < part.first + part.count; i += 3) {
                const std::uint32_t* corner = &mesh.indices()[i];
                const auto vertex = [&](int c) {
                    return glm::dvec3(matrix * glm::dvec4(mesh.positions()[corner[c]], 1.0));
                };
                const glm::dvec3 a = vertex(0);
                const glm::dvec3 ab = vertex(1) - a;
                const glm::dvec3 ac = vertex(2) - a;
                const glm::dvec3 d(ray.d);
                const glm::dvec3 p = glm::cross(d, ac);
                const double determinant = glm::dot(ab, p);
                const glm::dvec3 s = glm::dvec3(ray.origin) - a;
                const glm::dvec3 q = glm::cross(s, ab);
                const double u = glm::dot(s, p) / determinant;
                const double v = glm::dot(d, q) / determinant;
                const double t = glm::dot(ac, q) / determinant;
                if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < nearest.t)) continue;
                const auto mix = [&](const auto& values) {
                    return (1.0 - u - v) * values(0) + u * values(1) + v * values(2);
                };
                nearest.t = t;
                nearest.object = o;
                nearest.material = object.materials[std::min(part.slot, int(object.materials.size()) - 1)];
                const auto local = [&](int c) { return glm::dvec3(mesh.positions()[corner[c]]); };
                nearest.geometric_normal =
                    glm::normalize(normal_matrix * glm::cross(local(1) - local(0), local(2) - local(0)));
                nearest.normal = glm::normalize(
                    normal_matrix * mix([&](int c) { return glm::dvec3(mesh.normals()[corner[c]]); }));
                if (!mesh.uvs().empty())
                    nearest.uv = mix([&](int c) { return glm::dvec2(mesh.uvs()[corner[c]]); });
            }
        }
    }
    return nearest;
}

// Rays through an edge may meet either triangle: a few in ten thousand.
void expect_truth(const RayScene& rays, const Scene& scene, int count = 400, float precision = 1e-5F) {
    const std::vector<Ray> asked = random_rays(count);
    std::vector<Hit> hits(asked.size());
    rays.intersect(asked, hits);
    int met = 0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
        const Truth truth = truth_of(scene, asked[i]);
        const Hit& hit = hits[i];
        ASSERT_EQ(hit.object, truth.object) << i;
        EXPECT_EQ(hit.material, truth.material) << i;
        EXPECT_EQ(rays.escapes(asked[i].origin, asked[i].d), truth.object < 0) << i;
        if (truth.object < 0) {
            EXPECT_EQ(hit.t, std::numeric_limits<float>::infinity());
            continue;
        }
        ++met;
        EXPECT_NEAR(hit.t, truth.t, 1e-5 * truth.t) << i;
        EXPECT_LT(glm::length(hit.position - (asked[i].origin + hit.t * asked[i].d)), precision) << i;
        EXPECT_LT(glm::length(glm::dvec3(hit.geometric_normal) - truth.geometric_normal), 10.0F * precision)
            << i;
        EXPECT_LT(glm::length(glm::dvec3(hit.normal) - truth.normal), 10.0F * precision) << i;
        EXPECT_LT(glm::length(glm::dvec2(hit.uv) - truth.uv), 10.0F * precision) << i;
    }
    EXPECT_GE(met, scene.objects.empty() ? 0 : count / 8);
}

// A user loses: right pictures of scenes with several objects, instances, scaled and mirrored ones, and
// materials by face.
TEST(RayScene, MeetsWhatTryingEveryTriangleMeets) {
    const MeshPointer several = ball("several", 0.0F, 3);
    const MeshPointer one = ball("one", 1.0F);
    const Scene scene =
        scene_of({{"a", several, at(vec3(-1.5F, 0, 0)), {4, 2, 7}},
                  {"nothing",
                   std::make_shared<const Mesh>("empty", std::vector<vec3>{}, std::vector<vec3>{},
                                                std::vector<uvec3>{}, std::vector<std::uint16_t>{}),
                   mat4(1.0F),
                   {0}},
                  {"b", one, at(vec3(1.5F, 0, 0)), {1}},
                  {"mirrored", several, glm::scale(at(vec3(0, 2, 1)), vec3(-0.5F, 1.0F, 1.5F)), {3, 5}}});
    expect_truth(RayScene(scene), scene);
}

// A user loses: an empty scene, which is just background.
TEST(RayScene, MayBeEmpty) {
    RayScene rays;
    expect_truth(rays, Scene(), 20);
    const Scene scene = scene_of({{"a", ball("a"), mat4(1.0F), {0}}});
    rays.update(scene);
    expect_truth(rays, scene);
    rays.update(Scene());
    expect_truth(rays, Scene(), 20);
}

// A user loses: every frame of an animation after the first one.
TEST(RayScene, FollowsMovedAndDeformedAndNewAndDroppedMeshes) {
    const auto frame = [](float time) {
        return scene_of({{"moves", ball("moves"), at(vec3(time - 1.5F, 0, 0)), {1}},
                         {"deforms", ball("deforms", 3.0F * time, 2), at(vec3(0, 2, 0)), {2, 3}},
                         {"its instance", ball("deforms", 3.0F * time, 2), at(vec3(0, -2, 0)), {4}}});
    };
    Scene scene = frame(0.0F);
    scene.objects[2].mesh = scene.objects[1].mesh;
    RayScene rays(scene);
    for (const float time : {0.3F, 0.6F, 0.6F, 3.0F}) {
        Scene next = frame(time);
        next.objects[0].mesh = scene.objects[0].mesh;
        next.objects[2].mesh = next.objects[1].mesh;
        rays.update(next);
        SCOPED_TRACE(time);
        expect_truth(rays, next);
        scene = next;
    }
    scene.objects.erase(scene.objects.begin());
    scene.objects.push_back({"new", ball("new", 2.0F, 1, 7), at(vec3(0, 0, 1)), {5}});
    rays.update(scene);
    expect_truth(rays, scene);
    scene.objects[0].materials = {6};
    rays.update(scene);
    expect_truth(rays, scene);
}

vec3 twisted(const vec3& p, float turns) {
    const float angle = glm::two_pi<float>() * turns * p.z;
    return {std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y,
            p.z};
}

MeshPointer twisted(const Mesh& mesh, float turns) {
    std::vector<vec3> positions;
    for (const vec3& p : mesh.positions()) positions.push_back(twisted(p, turns));
    std::vector<uvec3> triangles;
    for (std::size_t i = 0; i < mesh.indices().size(); i += 3)
        triangles.emplace_back(mesh.indices()[i], mesh.indices()[i + 1], mesh.indices()[i + 2]);
    return std::make_shared<const Mesh>(mesh.name(), positions, positions, triangles,
                                        std::vector<std::uint16_t>());
}

// A user loses: quick frames after a deformation that wears a refit tree out, or after one that doesn't.
TEST(RefitCost, TellsBendingFromTwisting) {
    const MeshPointer before = ball("ball", 0.0F, 1, 40);
    EXPECT_FLOAT_EQ(refit_cost(*before, *before), 1.0F);
    EXPECT_LT(refit_cost(*before, *ball("ball", 2.0F, 1, 40)), 1.2F);
    EXPECT_LT(refit_cost(*before, *twisted(*before, 0.05F)), 1.2F);
    EXPECT_GT(refit_cost(*before, *twisted(*before, 1.0F)), 1.4F);
    const Mesh empty("empty", {}, {}, {}, {});
    EXPECT_EQ(refit_cost(empty, empty), 1.0F);
}

// A user loses: what a mesh has become, whether its tree was refit or built anew.
TEST(RayScene, FollowsDeformationsOfAnyStrength) {
    const MeshPointer before = ball("ball", 0.0F, 1, 30);
    Scene scene = scene_of({{"a", before, mat4(1.0F), {1}}});
    RayScene rays(scene);
    for (const float turns : {0.05F, 1.0F, 1.05F, 3.0F}) {
        scene.objects[0].mesh = twisted(*before, turns);
        rays.update(scene);
        SCOPED_TRACE(turns);
        expect_truth(rays, scene, 200, 1e-4F);  // twisted triangles are slivers, of which float knows less
    }
}

// A user loses: glass that is told from air, in mirrored objects; and the picture, when an object is scaled
// to nothing.
TEST(RayScene, KnowsOutwardOfAnyMatrix) {
    const Scene scene =
        scene_of({{"mirrored", ball("ball"), glm::scale(at(vec3(1, 0, 0)), vec3(-1, 2, 1)), {1}},
                  {"flat", ball("flat"), glm::scale(mat4(1.0F), vec3(1, 1, 0)), {1}}});
    const RayScene rays(scene);
    int met = 0;
    for (const Ray& ray : random_rays(300)) {
        const auto hit = rays.intersect(ray.origin, ray.d);
        if (!hit) continue;
        ++met;
        ASSERT_EQ(hit->object, 0);
        EXPECT_GT(glm::dot(hit->geometric_normal, hit->position - vec3(1, 0, 0)), 0.0F);
        EXPECT_GT(glm::dot(hit->normal, hit->position - vec3(1, 0, 0)), 0.0F);
    }
    EXPECT_GT(met, 50);
}

// A user loses: Blender, which Embree ends when a ray isn't finite.
TEST(RayScene, RaysThatAreNotFiniteMeetNothing) {
    const RayScene scene(scene_of({{"a", ball("a"), mat4(1.0F), {1}}}));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Ray> rays = {{vec3(0), vec3(0, 0, 1)},
                                   {vec3(nan), vec3(0, 0, 1)},
                                   {vec3(0), vec3(nan)},
                                   {vec3(1e30F, 0, 0), vec3(-1, 0, 0)},
                                   {vec3(0), vec3(std::numeric_limits<float>::infinity())}};
    std::vector<Hit> hits(rays.size());
    scene.intersect(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(hits[i].object, i == 0 ? 0 : -1) << i;
        EXPECT_EQ(scene.intersect(rays[i].origin, rays[i].d).has_value(), i == 0) << i;
        EXPECT_EQ(scene.escapes(rays[i].origin, rays[i].d), i != 0) << i;
    }
}

// A user loses: the right one of two meshes whose names are the same (linked from two files), or one that got
// other triangles under its old name.
TEST(RayScene, IsNotMisledByNames) {
    Scene scene = scene_of({{"a", ball("ball"), at(vec3(-1.5F, 0, 0)), {1}},
                            {"b", ball("ball", 2.0F), at(vec3(1.5F, 0, 0)), {2}}});
    RayScene rays(scene);
    std::swap(scene.objects[0].mesh, scene.objects[1].mesh);
    rays.update(scene);
    expect_truth(rays, scene);
    scene.objects[0].mesh = ball("ball", 1.0F, 3);  // as many triangles and vertices in another order
    scene.objects[1].mesh = ball("ball", 1.0F, 1, 9);
    rays.update(scene);
    expect_truth(rays, scene);
}

// A user loses: the same picture by many rays at once as by one after the other, whatever their number.
TEST(RayScene, ManyRaysMeetWhatEachMeets) {
    const RayScene scene(scene_of({{"a", ball("a", 0.0F, 3, 24), at(vec3(-1.5F, 0, 0)), {4, 2, 7}},
                                   {"b", ball("b", 1.0F, 1, 24), at(vec3(1.5F, 0, 0)), {1}}}));
    for (const int count : {0, 1, 3, 4, 7, 8, 9, 16, 31, 1000}) {
        const std::vector<Ray> rays = random_rays(count, count);
        std::vector<Hit> hits(rays.size());
        scene.intersect(rays, hits);
        for (int i = 0; i < count; ++i) {
            const Hit one = scene.intersect(rays[i].origin, rays[i].d).value_or(Hit::none());
            ASSERT_EQ(hits[i].object, one.object) << i << " of " << count;
            EXPECT_EQ(hits[i].material, one.material);
            if (one.object < 0) continue;
            EXPECT_NEAR(hits[i].t, one.t, 1e-5F * one.t);
            EXPECT_LT(glm::length(hits[i].position - one.position), 1e-5F);
            EXPECT_LT(glm::length(hits[i].normal - one.normal), 1e-4F);
        }
    }
}

}  // namespace
}  // namespace verglas
