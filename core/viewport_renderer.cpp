// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/viewport_renderer.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace verglas {
namespace {

using Clock = std::chrono::steady_clock;

// After a quick picture, before one of all pixels is begun: so long a hand that turns the view may rest, and
// Blender has the processor for drawing.
constexpr std::chrono::milliseconds rest(120);

constexpr int most_pixel_size = 8;
constexpr int first_pixel_size = 4;  // as long as it isn't known what pictures take

std::size_t pixels_of(const Settings& settings) {
    return rendered_rect(settings.size, settings.region).pixels();
}

// Time that pictures take for each square that is shaded; 0: not known yet.
struct Pace {
    double full = 0.0;
    double quick = 0.0;

    void note(const Settings& settings, double seconds) {
        const double squares = static_cast<double>(pixels_of(settings)) / squared(settings.pixel_size);
        (settings.pixel_size == 1 ? full : quick) = seconds / std::max(squares, 1.0);
    }
    // The least that keeps within the time.
    int pixel_size(const Settings& settings, double seconds) const {
        const auto pixels = static_cast<double>(pixels_of(settings));
        if (full > 0.0 && full * pixels <= seconds) return 1;
        const double known = quick > 0.0 ? quick : full;
        if (known == 0.0) return first_pixel_size;
        int size = 2;
        while (size < most_pixel_size && known * pixels / squared(size) > seconds) ++size;
        return size;
    }

  private:
    static double squared(double x) { return x * x; }
};

}  // namespace

// What a viewport wants to be shown.
struct ViewportRenderer::Request {
    Scene scene;
    Settings settings;
    double seconds;
};

// A viewport's.
struct ViewportRenderer::Job {
    // Guarded by Shared::mutex.
    std::optional<Request> wanted;  // newer than what is being made
    std::optional<Shown> news;
    std::string fault;
    bool is_done = true;
    bool is_removed = false;

    // The worker's.
    Request made;
    std::unique_ptr<GrowingPicture> quick;
    std::unique_ptr<GrowingPicture> full;
    int samples = 0;  // of full; 0: it must begin
    Clock::time_point due;
    Pace pace;
};

struct ViewportRenderer::Shared {
    std::mutex mutex;
    std::condition_variable wake;
    std::vector<std::shared_ptr<Job>> jobs;
    bool stop = false;
};

class ViewportRenderer::Worker {
  public:
    Worker(std::shared_ptr<Shared> shared, MakePicture make)
        : shared_(std::move(shared)), make_(std::move(make)) {}

    void run();

  private:
    std::shared_ptr<Job> next_job(std::unique_lock<std::mutex>& lock);
    void work(Job& job, bool is_new, std::unique_lock<std::mutex>& lock);
    std::optional<Shown> make_first(Job& job);
    std::optional<Shown> make_next(Job& job);
    std::optional<Shown> make_quick(Job& job, int pixel_size);
    bool is_in_the_way(const Job& job) const;

    std::shared_ptr<Shared> shared_;
    MakePicture make_;
};

void ViewportRenderer::Worker::run() {
    std::unique_lock lock(shared_->mutex);
    while (const std::shared_ptr<Job> job = next_job(lock)) {
        const bool is_new = job->wanted.has_value();
        if (is_new) {
            job->made = std::move(*job->wanted);
            job->wanted.reset();
            job->samples = 0;
        }
        work(*job, is_new, lock);
    }
    // Pictures may have to be freed before what makes them.
    for (const auto& job : shared_->jobs) {
        job->quick.reset();
        job->full.reset();
    }
}

// Waits for one; null at the end.
std::shared_ptr<ViewportRenderer::Job> ViewportRenderer::Worker::next_job(
    std::unique_lock<std::mutex>& lock) {
    while (!shared_->stop) {
        std::erase_if(shared_->jobs, [](const auto& job) { return job->is_removed; });
        const Clock::time_point now = Clock::now();
        std::shared_ptr<Job> next;
        std::optional<Clock::time_point> due;
        for (const auto& job : shared_->jobs) {
            if (job->wanted) return job;
            if (job->is_done) continue;
            if (job->due > now)
                due = due ? std::min(*due, job->due) : job->due;
            else if (!next || job->samples < next->samples)
                next = job;
        }
        if (next) return next;
        if (due)
            shared_->wake.wait_until(lock, *due);
        else
            shared_->wake.wait(lock);
    }
    return nullptr;
}

void ViewportRenderer::Worker::work(Job& job, bool is_new, std::unique_lock<std::mutex>& lock) {
    std::optional<Shown> shown;
    std::string fault;
    lock.unlock();
    try {
        shown = is_new ? make_first(job) : make_next(job);
    } catch (const std::bad_alloc&) {
        fault = "There isn't enough memory for the picture.";
    } catch (const std::exception& error) {
        fault = error.what();
    }
    lock.lock();
    if (!fault.empty()) job.samples = 0;
    if (shown) job.news = std::move(shown);
    if (job.wanted) return;
    job.fault = fault;
    job.is_done = !fault.empty() || job.samples >= job.made.settings.samples;
}

std::optional<Shown> ViewportRenderer::Worker::make_first(Job& job) {
    const int pixel_size = job.pace.pixel_size(job.made.settings, job.made.seconds);
    return pixel_size > 1 ? make_quick(job, pixel_size) : make_next(job);
}

// It is finished even if something else is asked for: while the view turns, that is always so.
std::optional<Shown> ViewportRenderer::Worker::make_quick(Job& job, int pixel_size) {
    if (!job.quick) job.quick = make_();
    Settings settings = job.made.settings;
    settings.samples = 1;
    settings.pixel_size = pixel_size;
    job.quick->begin(job.made.scene, settings);
    const auto go_on = [&](int, int) {
        const std::lock_guard lock(shared_->mutex);
        return !shared_->stop && !job.is_removed;
    };
    if (!job.quick->grow(1, go_on)) return std::nullopt;
    std::optional<Frame> frame = job.quick->frame(go_on);
    if (!frame) return std::nullopt;
    job.pace.note(settings, frame->seconds);
    job.due = Clock::now() + rest;
    return Shown{std::make_shared<const Frame>(std::move(*frame)), settings};
}

// Of all pixels, with one sample or twice as many as before.
std::optional<Shown> ViewportRenderer::Worker::make_next(Job& job) {
    if (!job.full) job.full = make_();
    Settings settings = job.made.settings;
    const int before = std::exchange(job.samples, 0);  // in case that it ends early
    if (before == 0) job.full->begin(job.made.scene, settings);
    const int samples = std::min(std::max(2 * before, 1), settings.samples);
    const auto go_on = [&](int, int) { return !is_in_the_way(job); };
    if (!job.full->grow(samples, go_on)) return std::nullopt;
    std::optional<Frame> frame = job.full->frame(go_on);
    if (!frame) return std::nullopt;
    if (samples == 1) job.pace.note(settings, frame->seconds);
    job.samples = settings.samples = samples;
    return Shown{std::make_shared<const Frame>(std::move(*frame)), settings};
}

bool ViewportRenderer::Worker::is_in_the_way(const Job& job) const {
    const std::lock_guard lock(shared_->mutex);
    return shared_->stop || job.is_removed ||
           std::any_of(shared_->jobs.begin(), shared_->jobs.end(),
                       [](const auto& other) { return other->wanted.has_value(); });
}

ViewportRenderer::ViewportRenderer(MakePicture make) : shared_(std::make_shared<Shared>()) {
    thread_ = std::thread([worker = Worker(shared_, std::move(make))]() mutable { worker.run(); });
}

void ViewportRenderer::stop() {
    {
        const std::lock_guard lock(shared_->mutex);
        shared_->stop = true;
    }
    shared_->wake.notify_all();
    if (thread_.joinable()) thread_.join();
}

ViewportRenderer::View::View(const ViewportRenderer& renderer)
    : shared_(renderer.shared_), job_(std::make_shared<Job>()) {
    const std::lock_guard lock(shared_->mutex);
    shared_->jobs.push_back(job_);
}

ViewportRenderer::View::~View() {
    {
        const std::lock_guard lock(shared_->mutex);
        job_->is_removed = true;
    }
    shared_->wake.notify_all();
}

void ViewportRenderer::View::show(Scene scene, const Settings& settings, double seconds) {
    {
        const std::lock_guard lock(shared_->mutex);
        job_->wanted = Request{std::move(scene), settings, seconds};
        job_->is_done = false;
    }
    shared_->wake.notify_all();
}

std::optional<Shown> ViewportRenderer::View::take() {
    const std::lock_guard lock(shared_->mutex);
    return std::exchange(job_->news, std::nullopt);
}

bool ViewportRenderer::View::has_news() const {
    const std::lock_guard lock(shared_->mutex);
    return job_->news.has_value();
}

bool ViewportRenderer::View::is_done() const {
    const std::lock_guard lock(shared_->mutex);
    return job_->is_done;
}

std::string ViewportRenderer::View::fault() const {
    const std::lock_guard lock(shared_->mutex);
    return job_->fault;
}

}  // namespace verglas
