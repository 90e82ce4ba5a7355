// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/media.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

#include "core/tracing/path_tracer.h"
#include "core/tracing/traced_renderer.h"
#include "tests/core/shapes.h"

namespace verglas {
namespace {

using glm::mat4;
using glm::vec3;

Material medium(float ior, int priority, const vec3& absorption = vec3(0.0F)) {
    Material material;
    material.ior = ior;
    material.priority = priority;
    material.absorption = absorption;
    material.roughness = 0.2F;
    return material;
}

Scene scene_of(std::vector<Material> materials) {
    Scene scene;
    scene.materials = std::move(materials);
    return scene;
}

Hit hit_of(int solid, float t = 1.0F) {
    Hit hit;
    hit.t = t;
    hit.object = hit.material = solid;
    return hit;
}

// Solids as intervals of a line, which a ray goes along from outside of all.
struct Line {
    struct Solid {
        float begin, end;
    };
    Scene scene;  // a material for each solid
    std::vector<Solid> solids;

    // Solid that counts at x by the definition: of highest priority, and of these the one entered last; -1:
    // none.
    int counted(float x) const {
        int result = -1;
        for (int i = 0; i < int(solids.size()); ++i) {
            if (scene.materials[i].priority == 0 || !contains(i, x)) continue;
            const auto rank = [this](int k) {
                return std::pair(scene.materials[k].priority, solids[k].begin);
            };
            if (result < 0 || rank(i) > rank(result)) result = i;
        }
        return result;
    }
    vec3 absorption(float x) const {
        vec3 sum(0.0F);
        for (int i = 0; i < int(solids.size()); ++i) {
            if (i == counted(x) || (contains(i, x) && scene.materials[i].priority == 0))
                sum += scene.materials[i].absorption;
        }
        return sum;
    }
    float ior(float x) const { return counted(x) < 0 ? 1.0F : scene.materials[counted(x)].ior; }
    bool contains(int i, float x) const { return solids[i].begin < x && x < solids[i].end; }
};

Line random_line(std::mt19937& random) {
    std::uniform_real_distribution<float> unit(0.0F, 1.0F);
    Line line;
    for (int i = 0; i < 6; ++i) {
        line.scene.materials.push_back(medium(1.1F + 0.1F * float(i), int(4.0F * unit(random)),
                                              vec3(unit(random), unit(random), unit(random))));
        const float begin = 3.0F * unit(random);
        line.solids.push_back({begin, begin + 0.1F + unit(random)});
    }
    return line;
}

// A user loses: drinks in glasses and stones in ice whose walls bend light as they do where they touch. The
// truth is the rule itself, applied to whole solids instead of their surfaces.
TEST(MediumStack, FollowsTheRuleAlongRandomLines) {
    std::mt19937 random(3);
    for (int n = 0; n < 300; ++n) {
        const Line line = random_line(random);
        struct Event {
            float x;
            int solid;
            bool entering;
        };
        std::vector<Event> events;
        for (int i = 0; i < int(line.solids.size()); ++i) {
            events.push_back({line.solids[i].begin, i, true});
            events.push_back({line.solids[i].end, i, false});
        }
        std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.x < b.x; });
        events.push_back({100.0F, -1, false});
        MediumStack media;
        float last = 0.0F;
        int inside = 0;
        for (auto event = events.begin(); event->solid >= 0; ++event) {
            inside += event->entering ? 1 : -1;
            if (inside > 4) break;  // more than it remembers
            const Hit hit = hit_of(event->solid, event->x - last);
            const float before = 0.5F * (last + event->x);
            const float behind = 0.5F * (event->x + std::next(event)->x);
            const vec3 expected = glm::exp(-line.absorption(before) * hit.t);
            EXPECT_LT(glm::distance(media.transmittance(line.scene, hit, event->entering), expected), 1e-5F);
            const auto interface = media.interface(line.scene, hit, event->entering);
            const Material& material = line.scene.materials[event->solid];
            if (material.priority == 0) {
                EXPECT_TRUE(interface.is_real);
                EXPECT_FLOAT_EQ(interface.eta, event->entering ? material.ior : 1.0F / material.ior);
            } else {
                EXPECT_EQ(interface.is_real, line.counted(before) != line.counted(behind));
                EXPECT_FLOAT_EQ(interface.eta, line.ior(behind) / line.ior(before));
            }
            media.cross(hit, event->entering);
            last = event->x;
        }
    }
}

// A user loses: a drink modelled by overlap, as it is done: it reaches into the wall of its glass.
TEST(MediumStack, LiquidThatReachesIntoItsGlass) {
    const Scene scene = scene_of({medium(1.5F, 2), medium(1.33F, 1)});
    const Hit glass = hit_of(0);
    const Hit liquid = hit_of(1);
    MediumStack media;
    EXPECT_FLOAT_EQ(media.interface(scene, glass, true).eta, 1.5F);
    media.cross(glass, true);
    EXPECT_FALSE(media.interface(scene, liquid, true).is_real);
    EXPECT_FALSE(media.interface(scene, liquid, true).bends());
    media.cross(liquid, true);
    EXPECT_FLOAT_EQ(media.interface(scene, glass, false).eta, 1.33F / 1.5F);
    media.cross(glass, false);
    EXPECT_FLOAT_EQ(media.interface(scene, liquid, false).eta, 1.0F / 1.33F);
}

// A user loses: scenes made for Cycles, where each surface has its own relative index.
TEST(MediumStack, WithoutPrioritySurfacesStandByThemselves) {
    const Scene scene = scene_of({medium(1.5F, 0), medium(0.8F, 0), medium(1.4F, 1)});
    MediumStack media;
    media.cross(hit_of(0), true);
    media.cross(hit_of(2), true);
    EXPECT_FLOAT_EQ(media.interface(scene, hit_of(1), true).eta, 0.8F);
    EXPECT_FLOAT_EQ(media.interface(scene, hit_of(1), false).eta, 1.0F / 0.8F);
    EXPECT_FLOAT_EQ(media.interface(scene, hit_of(2), false).eta, 1.0F / 1.4F);
}

// A user loses: parts of one material that overlap, as modelled things do, without seams where they meet.
TEST(MediumStack, OneMaterialIsOneMedium) {
    Scene scene = scene_of({medium(1.5F, 1)});
    Hit other = hit_of(0);
    other.object = 1;
    for (const Hit& hit : {hit_of(0), other}) {
        MediumStack media;
        media.cross(hit_of(0), true);
        EXPECT_FALSE(media.interface(scene, hit, true).is_real);
        media.cross(hit, true);
        EXPECT_FALSE(media.interface(scene, hit_of(0), false).is_real);
        media.cross(hit_of(0), false);
        EXPECT_FLOAT_EQ(media.interface(scene, hit, false).eta, 1.0F / 1.5F);
    }
    scene.materials[0] =
        medium(1.5F, 0, vec3(1.0F));  // a mesh that overlaps itself absorbs once, two objects twice
    MediumStack media;
    media.cross(hit_of(0), true);
    media.cross(hit_of(0), true);
    EXPECT_FLOAT_EQ(media.transmittance(scene, other, true).x, std::exp(-1.0F));
    media.cross(other, true);
    EXPECT_FLOAT_EQ(media.transmittance(scene, other, false).x, std::exp(-2.0F));
}

// A user loses: a camera inside of glass, and meshes with holes; their light is bent and absorbed as far as
// is known.
TEST(MediumStack, LeavingWhatWasNeverEntered) {
    for (const int priority : {0, 1}) {
        const Scene scene = scene_of({medium(1.5F, priority, vec3(0.5F)), medium(1.2F, 3)});
        MediumStack media;
        EXPECT_FLOAT_EQ(media.interface(scene, hit_of(0), false).eta, 1.0F / 1.5F);
        EXPECT_FLOAT_EQ(media.transmittance(scene, hit_of(0, 2.0F), false).x, std::exp(-1.0F));
        media.cross(hit_of(0), false);
        EXPECT_FLOAT_EQ(media.transmittance(scene, hit_of(0), true).x, 1.0F);
        EXPECT_FLOAT_EQ(media.interface(scene, hit_of(0), true).eta, 1.5F);
        media.cross(hit_of(1), true);
        EXPECT_EQ(media.interface(scene, hit_of(0), false).is_real, priority == 0);  // was around the other
    }
}

// A user loses: solids whose walls are of several materials, as a glass with a frosted band: left through any
// wall, nothing of them stays with the ray.
TEST(MediumStack, WallsOfSeveralMaterials) {
    const Scene scene = scene_of({medium(1.5F, 1, vec3(0.5F)), medium(1.5F, 1, vec3(0.5F))});
    Hit frosted = hit_of(1);
    frosted.object = 0;
    MediumStack media;
    media.cross(hit_of(0), true);
    EXPECT_FLOAT_EQ(media.interface(scene, frosted, false).eta, 1.0F / 1.5F);
    EXPECT_FLOAT_EQ(media.transmittance(scene, frosted, false).x, std::exp(-0.5F));
    media.cross(frosted, false);
    EXPECT_FLOAT_EQ(media.transmittance(scene, hit_of(0), true).x, 1.0F);
}

// A user loses: heaps of glass deeper than is remembered without wrong colours for the rest of the ray's way.
TEST(MediumStack, MoreThanItRemembers) {
    Scene scene;
    for (int i = 0; i < 7; ++i) scene.materials.push_back(medium(1.1F + 0.1F * float(i), 1 + i, vec3(1.0F)));
    MediumStack media;
    for (int i = 0; i < 7; ++i) {
        EXPECT_TRUE(media.interface(scene, hit_of(i), true).is_real);
        media.cross(hit_of(i), true);
    }
    for (int i = 6; i >= 0; --i) {
        EXPECT_TRUE(media.interface(scene, hit_of(i), false).is_real);
        media.cross(hit_of(i), false);
    }
    EXPECT_FLOAT_EQ(media.interface(scene, hit_of(0), true).eta, 1.1F);
    EXPECT_FLOAT_EQ(media.transmittance(scene, hit_of(0), true).x, 1.0F);
}

// A picture whose environment is different in every direction, with a small bright sun.
Scene lit_scene(std::vector<Material> materials) {
    Scene scene = scene_of(std::move(materials));
    std::vector<vec3> pixels;
    for (int i = 0; i < 64 * 32; ++i) pixels.emplace_back(float(i % 64) / 64.0F, float(i) / 2048.0F, 0.3F);
    pixels[20 * 64 + 40] = vec3(200.0F);
    scene.environment_map = std::make_shared<const EnvironmentMap>("Sun", 64, 32, pixels);
    scene.environment_color = vec3(1.0F);
    scene.camera.view = glm::lookAt(vec3(0, -4, 0), vec3(0), vec3(0, 0, 1));
    scene.camera.projection = glm::perspective(0.6F, 1.0F, 0.1F, 100.0F);
    return scene;
}

void add(Scene& scene, std::shared_ptr<const Mesh> mesh, int material, const mat4& matrix = mat4(1.0F)) {
    scene.objects.push_back({"Object", std::move(mesh), matrix, {material}});
}

Frame path_traced(const Scene& scene) {
    PathSettings settings;
    settings.size = glm::ivec2(32);
    PathTracer tracer(scene, settings);
    EXPECT_TRUE(tracer.render(16));
    return tracer.frame();
}

Frame bundle_traced(const Scene& scene) {
    Settings settings;
    settings.size = glm::ivec2(32);
    settings.samples = 1;
    TracedRenderer renderer;
    const auto frame = renderer.render(scene, settings);
    EXPECT_TRUE(frame);
    return *frame;
}

struct Tracer {
    const char* name;
    Frame (*render)(const Scene& scene);
    double error;  // relative, of what should be the same picture
};

// Pictures, by both tracers.
class TracedMedia : public testing::TestWithParam<Tracer> {
  protected:
    Frame render(const Scene& scene) const { return GetParam().render(scene); }
    void expect_color(const Scene& scene, const vec3& expected) const;
};

// Bundles are cut off in the end: what they then show is a guess, without what is in the way.
INSTANTIATE_TEST_SUITE_P(Tracers, TracedMedia,
                         testing::Values(Tracer{"Paths", path_traced, 2e-4},
                                         Tracer{"Bundles", bundle_traced, 0.02}),
                         [](const auto& tracer) { return tracer.param.name; });

// Mean absolute difference, relative to the mean.
double difference(const Frame& a, const Frame& b) {
    double sum = 0.0;
    double mean = 0.0;
    for (std::size_t i = 0; i < a.combined.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            sum += std::abs(a.combined[i][c] - b.combined[i][c]);
            mean += b.combined[i][c];
        }
    }
    return sum / mean;
}

const mat4 inner_place = glm::scale(glm::translate(mat4(1.0F), vec3(0.3F, 0.0F, 0.2F)), vec3(0.4F));

// A user loses: inner parts that can't be seen in the real thing: a sphere in another of the same index is
// none, however rough it is, and whichever counts.
TEST_P(TracedMedia, EqualIndicesAreOneSolid) {
    Scene one = lit_scene({medium(1.5F, 2)});
    add(one, shapes::sphere(), 0);
    for (const int priority : {1, 2, 3}) {
        Scene two = one;
        two.materials.push_back(medium(1.5F, priority));
        two.materials.back().roughness = 0.7F;
        add(two, shapes::sphere(), 1, inner_place);
        EXPECT_LT(difference(render(two), render(one)), GetParam().error) << priority;
    }
}

// A user loses: an IOR of 1 as no glass at all, from outside and behind other glass.
TEST_P(TracedMedia, IndexOneIsNone) {
    for (const int priority : {0, 1}) {
        Scene scene = lit_scene({medium(1.5F, 2), medium(1.0F, priority)});
        add(scene, shapes::sphere(), 0, inner_place);
        const Frame alone = render(scene);
        add(scene, shapes::sphere(), 1);
        EXPECT_LT(difference(render(scene), alone), GetParam().error) << priority;
    }
}

// A user loses: the usual way to model a drink. It overlaps the wall of its glass; the same with one wall
// between them that has the relative index.
TEST_P(TracedMedia, OverlapEqualsASharedWall) {
    const vec3 absorption(0.2F, 0.5F, 1.0F);
    Scene overlap = lit_scene({medium(1.5F, 2), medium(1.33F, 1, absorption)});
    add(overlap, shapes::spheres({1.0F, -0.8F}), 0);
    add(overlap, shapes::spheres({0.9F}), 1);
    Scene shared = lit_scene({medium(1.5F, 0), medium(1.33F / 1.5F, 0, absorption)});
    add(shared, shapes::sphere(), 0);
    add(shared, shapes::spheres({0.8F}), 1);
    EXPECT_LT(difference(render(overlap), render(shared)), GetParam().error);
    Scene none = overlap;
    none.objects.pop_back();
    EXPECT_GT(difference(render(overlap), render(none)), 0.05);
}

// Looks down on the slabs' middle; nothing bends light, and the environment is 1.
Scene slabs(const std::vector<Material>& materials) {
    Scene scene = scene_of(materials);
    scene.environment_color = vec3(1.0F);
    scene.camera.view = glm::lookAt(vec3(0, 0, 20), vec3(0), vec3(0, 1, 0));
    scene.camera.projection = glm::ortho(-0.5F, 0.5F, -0.5F, 0.5F, 0.1F, 100.0F);
    return scene;
}

void TracedMedia::expect_color(const Scene& scene, const vec3& expected) const {
    const Frame frame = render(scene);
    for (const glm::vec4& pixel : frame.combined)
        ASSERT_LT(glm::distance(vec3(pixel), expected), 1e-4F) << pixel.x << " " << pixel.y << " " << pixel.z;
}

// A user loses: the colour of overlapping glass: by Beer and Lambert, of the solid that counts in each part,
// from both sides alike. One from 0 to 3, the other from 2 to 4, and what is inside of one alone.
TEST_P(TracedMedia, OverlapIsAbsorbedByTheHigherPriority) {
    const vec3 a(0.1F, 0.2F, 0.0F);
    const vec3 b(0.3F, 0.0F, 0.5F);
    const auto picture = [&](int priority_a, int priority_b) {
        Scene scene = slabs({medium(1.0F, priority_a, a), medium(1.0F, priority_b, b)});
        add(scene, shapes::slab(0.0F, 3.0F), 0);
        add(scene, shapes::slab(2.0F, 4.0F), 1);
        return scene;
    };
    expect_color(picture(2, 1), glm::exp(-3.0F * a - b));
    expect_color(picture(1, 2), glm::exp(-2.0F * a - 2.0F * b));
    expect_color(picture(1, 1), glm::exp(-3.0F * a - b));         // seen from above, b is entered first
    expect_color(picture(0, 0), glm::exp(-3.0F * a - 2.0F * b));  // as in Cycles
    expect_color(picture(0, 1), glm::exp(-3.0F * a - 2.0F * b));
}

// A user loses: tinted glass with something in it; the way before and behind the inner part is absorbed, too.
TEST_P(TracedMedia, GlassAroundAnInnerPartAbsorbs) {
    const vec3 a(0.1F, 0.2F, 0.0F);
    const vec3 b(0.3F, 0.0F, 0.5F);
    for (const int priority : {0, 1}) {
        Scene scene = slabs({medium(1.0F, priority, a), medium(1.0F, 2 * priority, b)});
        add(scene, shapes::slab(0.0F, 4.0F), 0);
        add(scene, shapes::slab(1.0F, 2.0F), 1);
        expect_color(scene, glm::exp((priority == 0 ? -4.0F : -3.0F) * a - b));
    }
}

// A user loses: the camera inside of tinted glass.
TEST_P(TracedMedia, CameraInside) {
    for (const int priority : {0, 1}) {
        Scene scene = slabs({medium(1.0F, priority, vec3(0.5F))});
        scene.camera.projection = glm::ortho(-0.5F, 0.5F, -0.5F, 0.5F, 18.0F, 100.0F);  // at Z = 2
        add(scene, shapes::slab(0.0F, 4.0F), 0);
        expect_color(scene, vec3(std::exp(-1.0F)));
    }
}

// A researcher loses: light that is drawn from the environment, through surfaces that don't bend it: a rough
// pane in the middle of a large tinted ball, of which all of its light crosses twice the radius.
TEST_P(TracedMedia, LightReachesInnerPartsThroughUnbentSurfaces) {
    const auto picture = [this](const vec3& absorption, int priority) {
        Scene scene = lit_scene({medium(1.5F, 0), medium(1.0F, priority, absorption)});
        scene.materials[0].roughness = 0.6F;
        const float size = 0.01F;
        add(scene, shapes::slab(-1.0F, 1.0F), 0, glm::scale(mat4(1.0F), vec3(1.5F * size)));
        add(scene, shapes::sphere(), 1);
        scene.camera.view = glm::lookAt(vec3(0, -3, 2), vec3(0), vec3(0, 0, 1));
        scene.camera.projection = glm::ortho(-size, size, -size, size, 0.1F, 100.0F);
        return render(scene);
    };
    const vec3 absorption(0.0F, 0.25F, 0.5F);
    for (const int priority : {0, 1}) {
        const Frame clear = picture(vec3(0.0F), priority);
        Frame expected = clear;
        for (glm::vec4& pixel : expected.combined) pixel *= glm::vec4(glm::exp(-2.0F * absorption), 1.0F);
        EXPECT_LT(difference(picture(absorption, priority), expected), 0.01 + GetParam().error);
    }
}

}  // namespace
}  // namespace verglas
