// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/traced_renderer.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/tracing/bundle_tracer.h"
#include "core/tracing/progressive_picture.h"
#include "core/tracing/traced_scene.h"
#include "core/tracing/upscaled_picture.h"
#include "core/upscaling.h"

namespace verglas {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Neighbouring rays visit the same nodes of the trees; larger tiles leave threads idle at the end.
constexpr int tile_size = 8;

// Tiles of the last step look at pixels around them, for each tile again.
constexpr int resolved_tile_size = 64;

// Memory of larger pictures isn't kept for the next: 44 bytes a pixel.
constexpr std::size_t most_kept_pixels = 1 << 22;

// Between two calls of progress.
constexpr double progress_seconds = 0.01;

std::vector<Rect> tiles_of(const Rect& rect, int size) {
    std::vector<Rect> tiles;
    for (int y = rect.begin.y; y < rect.end.y; y += size)
        for (int x = rect.begin.x; x < rect.end.x; x += size)
            tiles.push_back(Rect{{x, y}, {x + size, y + size}}.intersected(rect));
    return tiles;
}

void check(const Settings& settings) {
    if (settings.size.x < 1 || settings.size.y < 1) throw Error("A picture needs at least one pixel.");
    if (settings.samples < 1) throw Error("A picture needs at least one sample.");
    check_pixel_size(settings);
    if (settings.max_interfaces < 1) throw Error("Rays must cross at least one interface.");
    if (settings.threads < 0) throw Error("The number of threads can't be negative.");
    if (rendered_rect(settings.size, settings.region).empty())
        throw Error("The render region lies outside of the picture.");
}

// Calls work(0) to work(count - 1) on the arena's threads, and `go_on` on this one, between its works and at
// the end; returns false where that did, maybe before all was done. No thread waits for another, as some
// works take a hundred times as long as others.
template <typename Work, typename GoOn>
bool do_all(tbb::task_arena& arena, int count, Work work, GoOn go_on) {
    const std::thread::id caller = std::this_thread::get_id();
    std::atomic<int> next = 0;
    std::atomic<bool> ended = false;
    Clock::time_point asked = Clock::now();
    const auto ask = [&] {
        if (std::this_thread::get_id() != caller || seconds_since(asked) < progress_seconds) return;
        if (!go_on()) ended = true;
        asked = Clock::now();
    };
    const auto work_on = [&](int) {
        try {
            for (int i = next++; i < count && !ended; i = next++) {
                work(i);
                ask();
            }
        } catch (...) {
            ended = true;
            throw;
        }
    };
    arena.execute([&] { tbb::parallel_for(0, arena.max_concurrency(), work_on); });
    return !ended && go_on();
}

}  // namespace

// What pictures of one renderer share.
class TracedRenderer::Device {
  public:
    TracedScene scene;
    std::mutex rendering;
};

class TracedRenderer::Picture : public GrowingPicture {
  public:
    explicit Picture(std::shared_ptr<Device> device) : device_(std::move(device)) {}

    void begin(Scene scene, const Settings& settings) override;
    bool grow(int samples, const Progress& progress) override;
    std::optional<Frame> frame(const Progress& progress) override;
    void free_memory();

  private:
    template <typename Work>
    bool over(const Rect& rect, const Progress& progress, Work work, int size = tile_size);
    BundleTracer tracer(int sample) const { return {device_->scene, settings_, sample}; }
    bool trace_first(const Progress& progress);
    bool draw(int sample, const Progress& progress);
    bool resolve(const Rect& rect, const Progress& progress, Frame& frame);

    std::shared_ptr<Device> device_;
    Scene scene_;
    Settings settings_;
    std::optional<tbb::task_arena> arena_;
    ProgressivePicture sum_;
    TracedPicture drawn_;  // the newest further sample
    int samples_ = 0;
    double seconds_ = 0.0;
    std::map<std::string, double> prepare_seconds_;
};

void TracedRenderer::Picture::begin(Scene scene, const Settings& settings) {
    check(settings);
    scene_ = std::move(scene);
    settings_ = settings;
    int threads = tbb::task_arena::automatic;
    if (settings.threads > 0) threads = settings.threads;
    arena_.emplace(threads);
    Settings of_squares = settings;
    of_squares.size = squares_of({{}, settings.size}, settings.pixel_size).end;
    sum_.begin(squares_of(rendered_rect(settings.size, settings.region), settings.pixel_size), of_squares);
    samples_ = 0;
    seconds_ = 0.0;
}

// The work on all tiles of a rectangle; false where progress ended it.
template <typename Work>
bool TracedRenderer::Picture::over(const Rect& rect, const Progress& progress, Work work, int size) {
    const std::vector<Rect> tiles = tiles_of(rect, size);
    return do_all(
        *arena_, static_cast<int>(tiles.size()), [&](int i) { work(tiles[i]); },
        [&] { return !progress || progress(samples_, settings_.samples); });
}

bool TracedRenderer::Picture::grow(int samples, const Progress& progress) {
    const std::lock_guard lock(device_->rendering);
    arena_->execute([&] { device_->scene.update(scene_, settings_.lobes); });
    if (samples_ == 0) prepare_seconds_ = device_->scene.seconds();
    const Clock::time_point begin = Clock::now();
    bool go_on = samples_ > 0 || trace_first(progress);
    while (go_on && samples_ < samples) go_on = draw(samples_, progress);
    seconds_ += seconds_since(begin);
    return go_on;
}

bool TracedRenderer::Picture::trace_first(const Progress& progress) {
    const BundleTracer first = tracer(0);
    const bool done =
        over(sum_.first_rect(), progress, [&](const Rect& tile) { first.trace(tile, sum_.first()); }) &&
        over(sum_.first_rect(), progress, [&](const Rect& tile) { sum_.average(tile); });
    if (done) samples_ = 1;
    return done;
}

bool TracedRenderer::Picture::draw(int sample, const Progress& progress) {
    if (sample == 1) {
        const BundleTracer first = tracer(0);
        if (!over(sum_.drawn_rect(), progress, [&](const Rect& tile) { sum_.prepare(tile, first); }))
            return false;
        drawn_.begin(sum_.drawn_rect());
    }
    const BundleTracer further = tracer(sample);
    const bool done = over(sum_.drawn_rect(), progress, [&](const Rect& tile) {
        further.trace(tile, drawn_);
        sum_.add(tile, drawn_, sample);
    });
    if (done) samples_ = sample + 1;
    return done;
}

std::optional<Frame> TracedRenderer::Picture::frame(const Progress& progress) {
    const std::lock_guard lock(device_->rendering);
    arena_->execute([&] { device_->scene.update(scene_, settings_.lobes); });
    const Clock::time_point begin = Clock::now();
    const Rect rect = rendered_rect(settings_.size, settings_.region);
    Frame frame;
    frame.size = rect.size();
    frame.combined.resize(rect.pixels());
    frame.normal_depth.resize(rect.pixels());
    if (!resolve(rect, progress, frame)) return std::nullopt;
    seconds_ += seconds_since(begin);
    frame.seconds = seconds_;
    frame.prepare_seconds = prepare_seconds_;
    return frame;
}

bool TracedRenderer::Picture::resolve(const Rect& rect, const Progress& progress, Frame& frame) {
    const BundleTracer first = tracer(0);
    if (settings_.pixel_size > 1) {
        const UpscaledPicture upscaled(rect, settings_, sum_.first(), sum_.averaged(), first);
        return over(
            rect, progress, [&](const Rect& tile) { upscaled.resolve(tile, frame); }, resolved_tile_size);
    }
    if (samples_ == 1)
        return over(rect, progress, [&](const Rect& tile) { sum_.resolve_first(tile, first, frame); });
    sum_.set_samples(samples_);
    return over(
        rect, progress, [&](const Rect& tile) { sum_.resolve(tile, frame); }, resolved_tile_size);
}

// That of pictures that are too large to keep it for the next.
void TracedRenderer::Picture::free_memory() {
    drawn_ = {};
    if (sum_.first_rect().pixels() > most_kept_pixels || settings_.samples > 1) sum_ = {};
}

TracedRenderer::TracedRenderer()
    : device_(std::make_shared<Device>()), picture_(std::make_unique<Picture>(device_)) {}
TracedRenderer::~TracedRenderer() = default;

std::unique_ptr<GrowingPicture> TracedRenderer::make_picture() { return std::make_unique<Picture>(device_); }

std::optional<Frame> TracedRenderer::render(const Scene& scene, const Settings& settings,
                                            const Progress& progress) {
    const std::lock_guard lock(rendering_);
    picture_->begin(scene, settings);
    std::optional<Frame> frame;
    if (picture_->grow(settings.samples, progress)) frame = picture_->frame(progress);
    picture_->free_memory();
    return frame;
}

}  // namespace verglas
