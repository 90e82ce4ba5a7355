// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/traced_renderer.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/tracing/bundle_tracer.h"
#include "core/tracing/progressive_picture.h"
#include "core/tracing/traced_scene.h"

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

class TracedRenderer::Device {
  public:
    std::optional<Frame> render(const Scene& scene, const Settings& settings, const Progress& progress);

  private:
    std::optional<Frame> render(const Settings& settings, const Progress& progress, tbb::task_arena& arena);

    TracedScene scene_;
    ProgressivePicture sum_;
    std::mutex rendering_;
};

std::optional<Frame> TracedRenderer::Device::render(const Scene& scene, const Settings& settings,
                                                    const Progress& progress) {
    check(settings);
    const std::lock_guard lock(rendering_);
    tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
    arena.execute([&] { scene_.update(scene); });
    std::optional<Frame> frame = render(settings, progress, arena);
    if (sum_.first_rect().pixels() > most_kept_pixels || settings.samples > 1) sum_ = {};
    return frame;
}

std::optional<Frame> TracedRenderer::Device::render(const Settings& settings, const Progress& progress,
                                                    tbb::task_arena& arena) {
    const Clock::time_point begin = Clock::now();
    sum_.begin(rendered_rect(settings.size, settings.region), settings);
    Frame frame;
    frame.size = sum_.rect().size();
    frame.combined.resize(sum_.rect().pixels());
    frame.normal_depth.resize(sum_.rect().pixels());

    int sample = 0;
    const auto over = [&](const Rect& rect, auto work, int size = tile_size) {
        const std::vector<Rect> tiles = tiles_of(rect, size);
        return do_all(
            arena, static_cast<int>(tiles.size()), [&](int i) { work(tiles[i]); },
            [&] { return !progress || progress(sample, settings.samples); });
    };
    const BundleTracer first(scene_, settings, 0);
    bool go_on = over(sum_.first_rect(), [&](const Rect& tile) { first.trace(tile, sum_.first()); }) &&
                 over(sum_.first_rect(), [&](const Rect& tile) { sum_.average(tile); });
    const auto draw_further = [&] {
        bool drawn = over(sum_.drawn_rect(), [&](const Rect& tile) { sum_.prepare(tile, first); });
        TracedPicture picture;
        picture.begin(sum_.drawn_rect());
        for (sample = 1; drawn && sample < settings.samples; ++sample) {
            const BundleTracer tracer(scene_, settings, sample);
            drawn = over(sum_.drawn_rect(), [&](const Rect& tile) {
                tracer.trace(tile, picture);
                sum_.add(tile, picture, sample);
            });
        }
        return drawn &&
               over(
                   sum_.rect(), [&](const Rect& tile) { sum_.resolve(tile, frame); }, resolved_tile_size);
    };
    if (settings.samples == 1)
        go_on = go_on && over(sum_.rect(), [&](const Rect& tile) { sum_.resolve_first(tile, first, frame); });
    else
        go_on = go_on && draw_further();
    if (!go_on) return std::nullopt;
    frame.seconds = seconds_since(begin);
    frame.prepare_seconds = scene_.seconds();
    return frame;
}

TracedRenderer::TracedRenderer() : device_(std::make_unique<Device>()) {}
TracedRenderer::~TracedRenderer() = default;

std::optional<Frame> TracedRenderer::render(const Scene& scene, const Settings& settings,
                                            const Progress& progress) {
    return device_->render(scene, settings, progress);
}

}  // namespace verglas
