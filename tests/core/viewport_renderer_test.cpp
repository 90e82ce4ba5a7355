// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/viewport_renderer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/renderer.h"
#include "core/tracing/traced_renderer.h"
#include "tests/core/shapes.h"

namespace verglas {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using glm::ivec2;
using glm::mat4;
using glm::vec3;
using glm::vec4;

// A glass sphere before a world that is brighter on the right.
Scene sphere_scene(float roughness = 0.3F) {
    Scene scene;
    Material material;
    material.roughness = roughness;
    scene.materials = {material};
    scene.objects.push_back({"Sphere", shapes::sphere(), mat4(1.0F), {0}});
    scene.camera.view = glm::lookAt(vec3(0, -4, 0), vec3(0), vec3(0, 0, 1));
    scene.camera.projection = glm::perspective(0.7F, 4.0F / 3.0F, 0.1F, 100.0F);
    scene.environment_color = vec3(1.0F);
    std::vector<vec3> pixels;
    for (int i = 0; i < 64 * 32; ++i) pixels.emplace_back(0.2F + 0.8F * float(i % 64) / 64.0F);
    scene.environment_map = std::make_shared<const EnvironmentMap>("Map", 64, 32, pixels);
    return scene;
}

Settings settings_of(ivec2 size, int samples) {
    Settings settings;
    settings.size = size;
    settings.samples = samples;
    return settings;
}

template <typename Condition>
bool wait_for(Condition condition) {
    const Clock::time_point last = Clock::now() + 20s;
    while (!condition()) {
        if (Clock::now() > last) return false;
        std::this_thread::sleep_for(1ms);
    }
    return true;
}

float greatest_difference(const Frame& a, const Frame& b) {
    EXPECT_EQ(a.size, b.size);
    float greatest = 0.0F;
    for (std::size_t i = 0; i < a.combined.size(); ++i) {
        const vec4 difference = glm::abs(a.combined[i] - b.combined[i]);
        greatest = std::max({greatest, difference.x, difference.y, difference.z, difference.w});
    }
    return greatest;
}

template <typename Device>
class GrowingPictures : public testing::Test {
  public:
    Device device;
};
using Devices = testing::Types<Renderer, TracedRenderer>;
TYPED_TEST_SUITE(GrowingPictures, Devices);

// What the viewport ends with would differ from F12's picture.
TYPED_TEST(GrowingPictures, AreThoseOfAsManySamples) {
    const Scene scene = sphere_scene();
    const auto picture = this->device.make_picture();
    picture->begin(scene, settings_of({48, 36}, 8));
    for (const int samples : {1, 2, 4, 8}) {
        ASSERT_TRUE(picture->grow(samples, {}));
        const auto whole = this->device.render(scene, settings_of({48, 36}, samples));
        EXPECT_EQ(greatest_difference(*picture->frame({}), *whole), 0.0F) << samples;
    }
}

// One viewport's picture would be spoilt by another's.
TYPED_TEST(GrowingPictures, DoNotMix) {
    const Scene scenes[] = {sphere_scene(0.2F), sphere_scene(0.6F)};
    const Settings settings[] = {settings_of({48, 36}, 4), settings_of({32, 24}, 4)};
    std::unique_ptr<GrowingPicture> pictures[] = {this->device.make_picture(), this->device.make_picture()};
    for (int i = 0; i < 2; ++i) pictures[i]->begin(scenes[i], settings[i]);
    for (const int samples : {1, 4})
        for (const auto& picture : pictures) ASSERT_TRUE(picture->grow(samples, {}));
    for (int i = 0; i < 2; ++i) {
        const auto alone = this->device.render(scenes[i], settings[i]);
        EXPECT_EQ(greatest_difference(*pictures[i]->frame({}), *alone), 0.0F);
    }
}

// While the view turns, objects would swell, shrink or move, or the world's light bleed over their edges.
TYPED_TEST(GrowingPictures, QuickOnesAreNearTheWholeOnes) {
    const Scene scene = sphere_scene();
    Settings settings = settings_of({97, 70}, 1);  // no whole number of squares
    const auto whole = this->device.render(scene, settings);
    for (const int pixel_size : {2, 3, 4}) {
        settings.pixel_size = pixel_size;
        const auto quick = this->device.render(scene, settings);
        ASSERT_EQ(quick->size, settings.size);
        double sum = 0.0;
        int covered_otherwise = 0;
        for (std::size_t i = 0; i < quick->combined.size(); ++i) {
            const vec3 difference(quick->combined[i] - whole->combined[i]);
            sum += glm::dot(difference, difference) / 3.0;
            if ((quick->normal_depth[i].w > 1e9F) != (whole->normal_depth[i].w > 1e9F)) ++covered_otherwise;
        }
        const double rms = std::sqrt(sum / double(quick->combined.size()));
        this->RecordProperty("rms" + std::to_string(pixel_size), std::to_string(rms));
        EXPECT_LT(rms, 0.03) << pixel_size;
        EXPECT_LT(covered_otherwise, 97 * pixel_size) << pixel_size;
    }
}

// A viewport with a render border would show pixels of elsewhere.
TYPED_TEST(GrowingPictures, QuickOnesKeepToTheRegion) {
    Settings settings = settings_of({96, 72}, 1);
    settings.pixel_size = 4;
    const auto whole = this->device.render(sphere_scene(), settings);
    const Rect region{{21, 10}, {70, 50}};
    settings.region = region;
    const auto part = this->device.render(sphere_scene(), settings);
    ASSERT_EQ(part->size, region.size());
    double sum = 0.0;
    for (int y = region.begin.y; y < region.end.y; ++y) {
        for (int x = region.begin.x; x < region.end.x; ++x) {
            const vec4& expected = whole->combined[std::size_t(y) * 96 + x];
            const vec4 difference = part->combined[region.place({x, y})] - expected;
            sum += glm::dot(difference, difference) / 4.0;
        }
    }
    EXPECT_LT(std::sqrt(sum / double(region.pixels())), 0.005);  // squares at the border miss neighbours
}

TEST(GrowingPicture, RefusesQuickPicturesOfManySamples) {
    TracedRenderer device;
    Settings settings = settings_of({8, 8}, 2);
    settings.pixel_size = 2;
    EXPECT_THROW(device.render(sphere_scene(), settings), Error);
    settings.pixel_size = 0;
    EXPECT_THROW(device.render(sphere_scene(), settings), Error);
}

// The viewport would never become sharp, or go on working when it is.
TEST(ViewportRenderer, EndsWithTheWholePicture) {
    TracedRenderer device;
    ViewportRenderer viewports([&] { return device.make_picture(); });
    ViewportRenderer::View view(viewports);
    EXPECT_TRUE(view.is_done());
    view.show(sphere_scene(), settings_of({64, 48}, 4), 1e-6);
    EXPECT_FALSE(view.is_done());
    ASSERT_TRUE(wait_for([&] { return view.has_news(); }));
    const std::optional<Shown> quick = view.take();
    EXPECT_GT(quick->settings.pixel_size, 1);
    EXPECT_EQ(quick->frame->size, ivec2(64, 48));
    ASSERT_TRUE(wait_for([&] { return view.is_done(); }));
    const std::optional<Shown> last = view.take();
    EXPECT_EQ(last->settings, settings_of({64, 48}, 4));
    EXPECT_EQ(greatest_difference(*last->frame, *device.render(sphere_scene(), settings_of({64, 48}, 4))),
              0.0F);
    EXPECT_FALSE(view.take().has_value());
}

// A picture that is asked for again and again while the view turns would never come.
TEST(ViewportRenderer, ShowsSomethingWhileTheViewTurns) {
    TracedRenderer device;
    ViewportRenderer viewports([&] { return device.make_picture(); });
    ViewportRenderer::View view(viewports);
    int pictures = 0;
    EXPECT_TRUE(wait_for([&] {
        view.show(sphere_scene(), settings_of({320, 240}, 64), 1e-6);
        if (view.take()) ++pictures;
        return pictures >= 5;
    }));
}

// A second viewport would stand still until the first one has all its samples.
TEST(ViewportRenderer, ServesWhoAsks) {
    TracedRenderer device;
    ViewportRenderer viewports([&] { return device.make_picture(); });
    ViewportRenderer::View busy(viewports);
    busy.show(sphere_scene(), settings_of({200, 150}, 4096), 1.0);
    ASSERT_TRUE(wait_for([&] { return busy.has_news(); }));
    ViewportRenderer::View other(viewports);
    other.show(sphere_scene(), settings_of({32, 24}, 2), 1.0);
    EXPECT_TRUE(wait_for([&] { return other.is_done(); }));
    EXPECT_FALSE(busy.is_done());
}

// A picture of elsewhere.
class BrokenPicture : public GrowingPicture {
  public:
    explicit BrokenPicture(std::unique_ptr<GrowingPicture> whole) : whole_(std::move(whole)) {}
    void begin(Scene scene, const Settings& settings) override {
        if (scene.objects.empty()) throw std::bad_alloc();
        whole_->begin(std::move(scene), settings);
    }
    bool grow(int samples, const Progress& progress) override { return whole_->grow(samples, progress); }
    std::optional<Frame> frame(const Progress& progress) override { return whole_->frame(progress); }

  private:
    std::unique_ptr<GrowingPicture> whole_;
};

// A fault would end Blender, or the viewport for good.
TEST(ViewportRenderer, GoesOnAfterAFault) {
    TracedRenderer device;
    ViewportRenderer viewports([&] { return std::make_unique<BrokenPicture>(device.make_picture()); });
    ViewportRenderer::View view(viewports);
    view.show(Scene{}, settings_of({32, 24}, 2), 1.0);
    ASSERT_TRUE(wait_for([&] { return view.is_done(); }));
    EXPECT_NE(view.fault().find("memory"), std::string::npos);
    EXPECT_FALSE(view.has_news());
    view.show(sphere_scene(), settings_of({32, 24}, 2), 1.0);
    ASSERT_TRUE(wait_for([&] { return view.is_done(); }));
    EXPECT_EQ(view.fault(), "");
    EXPECT_TRUE(view.has_news());
}

// Closing a viewport or Blender would hang or crash while pictures are made.
TEST(ViewportRenderer, EndsAtOnce) {
    TracedRenderer device;
    auto viewports = std::make_unique<ViewportRenderer>([&] { return device.make_picture(); });
    auto gone = std::make_unique<ViewportRenderer::View>(*viewports);
    gone->show(sphere_scene(), settings_of({400, 300}, 65536), 1.0);
    ASSERT_TRUE(wait_for([&] { return gone->has_news(); }));
    gone.reset();
    ViewportRenderer::View left(*viewports);
    left.show(sphere_scene(), settings_of({400, 300}, 65536), 1.0);
    ASSERT_TRUE(wait_for([&] { return left.has_news(); }));
    const Clock::time_point begin = Clock::now();
    viewports.reset();
    EXPECT_LT(Clock::now() - begin, 5s);
    EXPECT_FALSE(left.is_done());
}

}  // namespace
}  // namespace verglas
