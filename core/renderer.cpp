// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/renderer.h"

#include <chrono>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/gl/debug.h"
#include "core/gl/timer.h"
#include "core/material/model.h"
#include "core/math/low_discrepancy.h"
#include "core/math/pixel_filter.h"
#include "core/passes/behind.h"
#include "core/passes/geometry.h"
#include "core/passes/gpu_scene.h"
#include "core/passes/pyramid.h"
#include "core/passes/shading.h"
#include "core/passes/view.h"
#include "core/upscaling.h"

namespace verglas {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Wall time of work on the GPU that returns whether there was any; else 0.
template <typename Work>
double seconds_of(Work work) {
    const Clock::time_point begin = Clock::now();
    if (!work()) return 0.0;
    glFinish();
    return seconds_since(begin);
}

// The pictures of one size.
struct Targets {
    Targets(glm::ivec2 frame_size, RoughnessData of_front, RoughnessData of_back, bool with_layers)
        : size(frame_size),
          front(size, of_front),
          class_pyramid(make_class_pyramid(size, of_back, with_layers ? 2 : 1)),
          back(size, of_back, class_pyramid),
          shaded(GL_RGBA32F, size.x, size.y, GL_NEAREST),
          sum(GL_RGBA32F, size.x, size.y, GL_NEAREST),
          shaded_framebuffer({{shaded}}),
          sum_framebuffer({{sum}}) {
        if (with_layers) inner.emplace(size, of_back, class_pyramid);
    }

    bool fit(glm::ivec2 frame_size, RoughnessData of_front, RoughnessData of_back, bool with_layers) const {
        return size == frame_size && front.roughness_data() == of_front && back.roughness_data() == of_back &&
               inner.has_value() == with_layers;
    }

    glm::ivec2 size;
    GeometryBuffer front;
    gl::Texture class_pyramid;
    GeometryBuffer back;
    std::optional<InnerLayers> inner;  // where the transport needs them
    gl::Texture shaded;                // the newest sample's objects; later the data passes
    gl::Texture sum;                   // of all samples
    gl::Framebuffer shaded_framebuffer;
    gl::Framebuffer sum_framebuffer;
};

// Moves the picture so that the pixel's centre looks where `offset` pixels from it lies.
glm::mat4 jittered(const glm::mat4& projection, glm::vec2 offset, glm::ivec2 size) {
    glm::mat4 shift(1.0F);
    shift[3][0] = -2.0F * offset.x / static_cast<float>(size.x);
    shift[3][1] = -2.0F * offset.y / static_cast<float>(size.y);
    return shift * projection;
}

// The projection of a frame whose lower left part, of the given size, has this one.
glm::mat4 reaching(glm::ivec2 frame, const glm::mat4& projection, glm::ivec2 size) {
    const glm::vec2 scale = glm::vec2(size) / glm::vec2(frame);
    glm::mat4 shrink(1.0F);
    for (int axis = 0; axis < 2; ++axis) {
        shrink[axis][axis] = scale[axis];
        shrink[3][axis] = scale[axis] - 1.0F;
    }
    return shrink * projection;
}

Rect region_of(const Settings& settings) { return rendered_rect(settings.size, settings.region); }

// GROUP_SIZE of shaders/geometry_buffer.glsl.
constexpr std::size_t max_materials = 4096;

void check(const Scene& scene, const Settings& settings) {
    if (settings.size.x < 1 || settings.size.y < 1) throw Error("A picture needs at least one pixel.");
    if (settings.samples < 1) throw Error("A picture needs at least one sample.");
    check_pixel_size(settings);
    if (settings.roughness_classes < 2 || settings.roughness_classes > model::MAX_ROUGHNESS_CLASSES)
        throw Error("A texture of roughness has 2 to " + std::to_string(model::MAX_ROUGHNESS_CLASSES) +
                    " classes.");
    if (region_of(settings).empty()) throw Error("The render region lies outside of the picture.");
    if (scene.materials.size() > max_materials)
        throw Error("The scene has " + std::to_string(scene.materials.size()) +
                    " materials; Verglas renders up to " + std::to_string(max_materials) + ".");
    for (const Object& object : scene.objects) {
        for (const int material : object.materials) {
            if (material < 0 || material >= static_cast<int>(scene.materials.size()))
                throw Error("Object '" + object.name + "' has a material that the scene doesn't know.");
        }
        if (object.materials.empty()) throw Error("Object '" + object.name + "' has no material.");
    }
}

}  // namespace

// What one picture has of its own. Lives on the GL thread.
struct Renderer::Canvas {
    std::unique_ptr<Targets> targets;
    std::vector<ViewGroup> groups;
    Unfilled<glm::vec4> normal_depth;
    std::map<std::string, double> prepare_seconds;
    double seconds = 0.0;
    double readback_seconds = 0.0;
    int samples = 0;
};

class Renderer::Device {
  public:
    Device() : materials_(user_cache_folder()) {}

    void prepare(const Scene& scene, const Settings& settings, Canvas& canvas);
    // After prepare(), with no other canvas' in between.
    void draw_sample(const Scene& scene, const Settings& settings, Canvas& canvas);
    Frame finish(const Settings& settings, Canvas& canvas);

  private:
    void draw_data(const ShadingInputs& inputs, const Canvas& canvas, const Rect& region);

    GeometryPass geometry_;
    RefractionPass refraction_;
    ThinLayerPass thin_layers_;
    BackgroundPass background_;
    DataPass data_;
    std::unique_ptr<PyramidPass> pyramid_;
    std::unique_ptr<BehindPass> behind_;  // from the first pane with something behind it
    gl::Timers timers_;
    MeshCache meshes_;
    TextureCache textures_;
    ReliefCache reliefs_;
    MaterialCache materials_;
    EnvironmentCache environment_;
    LightBuffer lights_;
};

namespace {

// From the GPU, which has finished.
Unfilled<glm::vec4> read(const gl::Texture& texture, const Rect& rect, double& seconds) {
    const Clock::time_point begin = Clock::now();
    Unfilled<glm::vec4> pixels(rect.pixels());
    glGetTextureSubImage(texture.id(), 0, rect.begin.x, rect.begin.y, 0, rect.size().x, rect.size().y, 1,
                         GL_RGBA, GL_FLOAT, static_cast<GLsizei>(pixels.size() * sizeof(glm::vec4)),
                         pixels.data());
    seconds += seconds_since(begin);
    return pixels;
}

}  // namespace

void Renderer::Device::prepare(const Scene& scene, const Settings& settings, Canvas& canvas) {
    std::map<std::string, double> seconds;
    seconds["meshes"] = seconds_of([&] { return meshes_.update(scene); });
    seconds["textures"] = seconds_of([&] {
        const bool new_roughness = textures_.update(scene.materials, settings.roughness_classes);
        return reliefs_.update(scene.materials) || new_roughness;
    });
    seconds["tables"] =
        seconds_of([&] { return materials_.update(scene.materials, textures_, settings.lobes); });
    seconds["environment"] = seconds_of([&] { return environment_.update(scene.environment_map); });
    lights_.update(scene.lights, scene.camera.view);
    if (!pyramid_ && RefractionPass::needs_pyramid(settings)) pyramid_ = std::make_unique<PyramidPass>();
    canvas.groups = group_objects(scene, meshes_, settings.size, region_of(settings));
    if (canvas.samples > 0) return;
    const bool varies = !textures_.empty() || materials_.has_thin_layers();
    const RoughnessData of_front = varies ? RoughnessData::Values : RoughnessData::None;
    const RoughnessData of_back = RefractionPass::back_data(settings, textures_.most_classes());
    const bool with_layers = RefractionPass::needs_layers(settings);
    if (!canvas.targets || !canvas.targets->fit(settings.size, of_front, of_back, with_layers)) {
        canvas.targets.reset();
        canvas.targets = std::make_unique<Targets>(settings.size, of_front, of_back, with_layers);
    }
    glDisable(GL_SCISSOR_TEST);
    constexpr float black[4] = {};
    glClearNamedFramebufferfv(canvas.targets->sum_framebuffer.id(), GL_COLOR, 0, black);
    timers_.collect();
    glFinish();
    canvas.prepare_seconds = seconds;
    canvas.seconds = 0.0;
    canvas.readback_seconds = 0.0;
}

void Renderer::Device::draw_sample(const Scene& scene, const Settings& settings, Canvas& canvas) {
    const Clock::time_point begin = Clock::now();
    const gl::PassScope scope("sample");
    const Rect region = region_of(settings);
    const Targets& targets = *canvas.targets;
    // The first sample looks through the pixel's centre.
    const glm::vec2 offset = blackman_harris_offset(r2_point(canvas.samples), settings.filter_width);
    const View view{scene.camera.view, jittered(scene.camera.projection, offset, settings.size),
                    settings.size};
    const ShadingInputs inputs{
        view, scene, settings, *environment_, targets.front, textures_.most_classes(), lights_};
    const Surfaces surfaces{scene.materials, textures_, reliefs_};
    const bool with_pyramid = RefractionPass::needs_pyramid(settings);
    const bool with_layers = RefractionPass::needs_layers(settings);
    const bool with_classes = class_layers(targets.back.roughness_data()) > 0;
    // Coarse levels see all of the frame.
    const auto back_rect = [&](const ViewGroup& group) {
        return with_pyramid || with_classes ? Rect{{}, settings.size} : group.rect;
    };
    geometry_.clear(targets.front, Faces::NearestFront, {glm::ivec2(0), settings.size});
    const bool has_others = !canvas.groups.empty() && !canvas.groups.front().is_of_panes();
    const BehindPass* behind = nullptr;
    for (int number = 0; number < static_cast<int>(canvas.groups.size()); ++number) {
        const ViewGroup& group = canvas.groups[number];
        if (group.is_of_panes() && has_others && behind == nullptr) {
            const gl::PassScope pass("picture behind panes");
            const gl::Timers::Scope timer(timers_, "behind");
            if (!behind_) behind_ = std::make_unique<BehindPass>();
            behind_->build(targets.front.texels(), targets.shaded);
            behind = behind_.get();
            pass.check();
        }
        const bool has_solids = group.has(MaterialKind::Solid);
        if (has_solids) {
            const gl::PassScope pass("back faces");
            const gl::Timers::Scope timer(timers_, "back_faces");
            geometry_.clear(targets.back, Faces::FarthestBack, back_rect(group));
            geometry_.draw(targets.back, Faces::FarthestBack, view, group, number, surfaces);
            pass.check();
        }
        if (has_solids && with_layers) {
            const gl::PassScope pass("inner layers");
            const gl::Timers::Scope timer(timers_, "inner_layers");
            geometry_.clear(targets.inner->nearest_back, Faces::NearestBack, back_rect(group));
            geometry_.draw(targets.inner->nearest_back, Faces::NearestBack, view, group, number, surfaces);
            geometry_.clear(targets.inner->farthest_front, Faces::FarthestFront, group.rect);
            geometry_.draw(targets.inner->farthest_front, Faces::FarthestFront, view, group, number,
                           surfaces);
            pass.check();
        }
        if (has_solids && with_classes) {
            const gl::PassScope pass("coverage pyramid");
            const gl::Timers::Scope timer(timers_, "coverage");
            glGenerateTextureMipmap(targets.class_pyramid.id());
            pass.check();
        }
        if (has_solids && with_pyramid) {
            const gl::PassScope pass("geometry pyramid");
            const gl::Timers::Scope timer(timers_, "pyramid");
            pyramid_->build(targets.back.texels());
            pass.check();
        }
        {
            const gl::PassScope pass("front faces");
            const gl::Timers::Scope timer(timers_, "front_faces");
            geometry_.draw(targets.front, Faces::NearestFront, view, group, number, surfaces);
            pass.check();
        }
        if (has_solids) {
            const gl::PassScope pass("refraction");
            const gl::Timers::Scope timer(timers_, "refraction");
            const BackGeometry back{targets.back, targets.class_pyramid,
                                    with_layers ? &*targets.inner : nullptr,
                                    with_pyramid ? pyramid_.get() : nullptr};
            refraction_.draw(inputs, targets.shaded_framebuffer, back, materials_, group, number);
            pass.check();
        }
        if (materials_.has_thin_layers()) {
            const gl::PassScope pass("thin layers");
            const gl::Timers::Scope timer(timers_, "thin_layers");
            thin_layers_.draw(inputs, targets.shaded_framebuffer, materials_, behind, group, number);
            pass.check();
        }
    }
    {
        const gl::PassScope pass("background");
        const gl::Timers::Scope timer(timers_, "background");
        background_.draw(inputs, targets.sum_framebuffer, targets.shaded, region);
        pass.check();
    }
    if (canvas.samples == 0) draw_data(inputs, canvas, region);
    glFinish();
    if (canvas.samples == 0) canvas.normal_depth = read(targets.shaded, region, canvas.readback_seconds);
    ++canvas.samples;
    canvas.seconds += seconds_since(begin);
}

// Depth and normals come from the sample through the pixel's centre, unfiltered.
void Renderer::Device::draw_data(const ShadingInputs& inputs, const Canvas& canvas, const Rect& region) {
    const gl::PassScope pass("data passes");
    const gl::Timers::Scope timer(timers_, "data");
    data_.draw(inputs, canvas.targets->shaded_framebuffer, region);
    pass.check();
}

Frame Renderer::Device::finish(const Settings& settings, Canvas& canvas) {
    const Clock::time_point begin = Clock::now();
    const gl::PassScope scope("readback");
    const Rect region = region_of(settings);
    Frame frame;
    frame.size = region.size();
    frame.combined = read(canvas.targets->sum, region, canvas.readback_seconds);
    const float share = 1.0F / static_cast<float>(canvas.samples);
    for (glm::vec4& pixel : frame.combined) pixel *= share;
    frame.normal_depth = canvas.normal_depth;
    canvas.seconds += seconds_since(begin);
    frame.seconds = canvas.seconds;
    frame.pass_seconds = timers_.collect();
    frame.pass_seconds["readback"] = canvas.readback_seconds;
    frame.prepare_seconds = canvas.prepare_seconds;
    scope.check();
    return frame;
}

class Renderer::Picture : public GrowingPicture {
  public:
    explicit Picture(Renderer& renderer) : renderer_(renderer), canvas_(std::make_unique<Canvas>()) {}
    ~Picture() override {
        renderer_.thread_.run([this] { canvas_.reset(); });
    }

    void begin(Scene scene, const Settings& settings) override;
    bool grow(int samples, const Progress& progress) override;
    std::optional<Frame> frame(const Progress& progress) override;

  private:
    Renderer& renderer_;
    Scene scene_;
    Settings settings_;  // of the squares that are shaded
    Rect rect_;          // pixels that are wanted
    std::unique_ptr<Canvas> canvas_;
};

void Renderer::Picture::begin(Scene scene, const Settings& settings) {
    check(scene, settings);
    scene_ = std::move(scene);
    settings_ = settings;
    rect_ = region_of(settings);
    canvas_->samples = 0;
    if (settings.pixel_size == 1) return;
    settings_.size = squares_of({{}, settings.size}, settings.pixel_size).end;
    settings_.region = squares_of(rect_, settings.pixel_size);
    scene_.camera.projection =
        reaching(settings_.size * settings.pixel_size, scene_.camera.projection, settings.size);
}

bool Renderer::Picture::grow(int samples, const Progress& progress) {
    const std::lock_guard lock(renderer_.rendering_);
    Device& device = *renderer_.device_;
    renderer_.thread_.run([&] { device.prepare(scene_, settings_, *canvas_); });
    while (canvas_->samples < samples) {
        renderer_.thread_.run([&] { device.draw_sample(scene_, settings_, *canvas_); });
        if (progress && !progress(canvas_->samples, settings_.samples)) return false;
    }
    return true;
}

std::optional<Frame> Renderer::Picture::frame(const Progress&) {
    const std::lock_guard lock(renderer_.rendering_);
    Frame frame = renderer_.thread_.run([&] { return renderer_.device_->finish(settings_, *canvas_); });
    if (settings_.pixel_size == 1) return frame;
    return upscaled(frame, *settings_.region, rect_, settings_.pixel_size);
}

Renderer::Renderer()
    : device_(thread_.run([] { return std::make_unique<Device>(); })),
      picture_(std::make_unique<Picture>(*this)) {}

Renderer::~Renderer() {
    picture_.reset();
    thread_.run([this] { device_.reset(); });
}

std::unique_ptr<GrowingPicture> Renderer::make_picture() { return std::make_unique<Picture>(*this); }

std::optional<Frame> Renderer::render(const Scene& scene, const Settings& settings,
                                      const Progress& progress) {
    const std::lock_guard lock(picture_mutex_);
    picture_->begin(scene, settings);
    if (!picture_->grow(settings.samples, progress)) return std::nullopt;
    return picture_->frame(progress);
}

}  // namespace verglas
