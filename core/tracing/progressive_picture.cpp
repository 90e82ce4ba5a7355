// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/progressive_picture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/pixel_filter.h"
#include "core/tracing/surface_average.h"

namespace verglas {
namespace {

// Looks through each pixel at an object's edge before the first drawn sample; these only need a ray.
constexpr int looks_ahead = 16;

// The window's pixels to each side. Of 1 to 4, least error on monkey, sphere and bottle from 1 to 256
// samples.
constexpr int window_reach = 2;

// Standard deviation of the first sample's error, as a share of its light, that is always thought possible:
// what many drawn samples agree on is then believed, however well the first sample does all around.
constexpr float possible_error = 0.05F;

float mean(const glm::vec3& v) { return (v.x + v.y + v.z) / 3.0F; }

float squared(float x) { return x * x; }

Rect grown(const Rect& rect, int margin, glm::ivec2 frame) {
    return Rect{rect.begin - margin, rect.end + margin}.intersected({glm::ivec2(0), frame});
}

// Whole pixels that sample_offset() reaches to each side.
int filter_reach(const Settings& settings) { return static_cast<int>(settings.filter_width + 0.5F); }

template <typename Work>
void for_each_pixel(const Rect& rect, Work work) {
    tbb::parallel_for(rect.begin.y, rect.end.y, [&](int y) {
        for (int x = rect.begin.x; x < rect.end.x; ++x) work(glm::ivec2(x, y));
    });
}

template <typename Work>
void for_each_neighbour(glm::ivec2 pixel, int reach, const Rect& rect, Work work) {
    const Rect around = Rect{pixel - reach, pixel + reach + 1}.intersected(rect);
    for (int y = around.begin.y; y < around.end.y; ++y)
        for (int x = around.begin.x; x < around.end.x; ++x) work(glm::ivec2(x, y));
}

// The share of what an error is found to be that is believed: it has this variance where all noise is away.
float believed(float variance, float noise) { return variance / (variance + noise); }

}  // namespace

struct ProgressivePicture::Estimate {
    int object;
    float scale;      // of all others
    float light;      // the first sample's
    glm::vec3 error;  // mean over samples
    float square;     // mean over samples
};

ProgressivePicture::ProgressivePicture(const Rect& rect, const Settings& settings)
    : settings_(settings),
      rect_(rect),
      drawn_rect_(settings.samples > 1 ? grown(rect, window_reach, settings.size) : rect),
      first_(Rect{}) {}

// Pixels of drawn_rect() look for neighbours of the pixels that they see, which average_surfaces() makes of
// theirs.
Rect ProgressivePicture::first_rect() const {
    const int margin = settings_.samples > 1 ? filter_reach(settings_) + 2 : 1;
    return grown(drawn_rect_, margin, settings_.size);
}

std::size_t ProgressivePicture::place(glm::ivec2 pixel) const {
    const glm::ivec2 inside = pixel - drawn_rect_.begin;
    return std::size_t(inside.y) * drawn_rect_.size().x + inside.x;
}

void ProgressivePicture::begin(TracedPicture first, const BundleTracer& tracer) {
    first_ = std::move(first);
    average_surfaces(first_);
    if (settings_.samples == 1) return;
    const int reach = filter_reach(settings_);
    for (int i = -reach; i <= reach; ++i)
        kernel_.push_back(blackman_harris_share(static_cast<float>(i) - 0.5F, static_cast<float>(i) + 0.5F,
                                                settings_.filter_width));
    pixels_.assign(std::size_t(drawn_rect_.size().x) * drawn_rect_.size().y, {});
    for_each_pixel(drawn_rect_, [&](glm::ivec2 pixel) {
        Pixel& result = pixels_[place(pixel)];
        result.object = first_.surfaces[first_.place(pixel.x, pixel.y)].object;
        if (is_edge(pixel)) {
            look_through(pixel, tracer, result);
        } else {
            result.base = filtered(pixel);
            result.covered = result.object >= 0 ? 1.0F : 0.0F;
        }
    });
}

bool ProgressivePicture::is_edge(glm::ivec2 pixel) const {
    const int object = first_.surfaces[first_.place(pixel.x, pixel.y)].object;
    bool found = false;
    for_each_neighbour(pixel, filter_reach(settings_), first_.rect, [&](glm::ivec2 other) {
        found |= first_.surfaces[first_.place(other.x, other.y)].object != object;
    });
    return found;
}

void ProgressivePicture::look_through(glm::ivec2 pixel, const BundleTracer& tracer, Pixel& result) const {
    for (int sample = 1; sample <= looks_ahead; ++sample) {
        const glm::vec2 at = glm::vec2(pixel) + 0.5F + sample_offset(pixel, sample, settings_);
        const BundleTracer::Sight sight = tracer.look(at);
        if (result.object < 0) result.object = sight.object;
        result.covered += sight.object >= 0 ? 1.0F : 0.0F;
        result.base += sight.object >= 0 ? seen(at, sight.object, glm::vec3(0.0F)) : sight.background;
    }
    result.looks = looks_ahead;
}

// What the pixel filter makes of the first sample.
glm::vec3 ProgressivePicture::filtered(glm::ivec2 pixel) const {
    const int reach = filter_reach(settings_);
    glm::vec3 sum(0.0F);
    float weights = 0.0F;
    for_each_neighbour(pixel, reach, first_.rect, [&](glm::ivec2 other) {
        const glm::ivec2 offset = other - pixel + reach;
        const float weight = kernel_[offset.x] * kernel_[offset.y];
        sum += weight * first_.radiance[first_.place(other.x, other.y)];
        weights += weight;
    });
    return sum / weights;
}

// What the first sample shows of an object at a place of the frame: its nearest pixel, if one is near.
glm::vec3 ProgressivePicture::seen(glm::vec2 place, int object, const glm::vec3& otherwise) const {
    glm::vec3 nearest = otherwise;
    float least = 1e9F;
    for_each_neighbour(glm::ivec2(glm::floor(place)), 1, first_.rect, [&](glm::ivec2 pixel) {
        const std::size_t i = first_.place(pixel.x, pixel.y);
        const glm::vec2 away = glm::vec2(pixel) + 0.5F - place;
        const float distance = glm::dot(away, away);
        if (first_.surfaces[i].object != object || distance >= least) return;
        nearest = first_.radiance[i];
        least = distance;
    });
    return nearest;
}

void ProgressivePicture::add(const TracedPicture& drawn) {
    const int sample = ++drawn_;
    for_each_pixel(drawn_rect_, [&](glm::ivec2 pixel) {
        Pixel& sum = pixels_[place(pixel)];
        const std::size_t i = drawn.place(pixel.x, pixel.y);
        const glm::vec3& radiance = drawn.radiance[i];
        const int object = drawn.surfaces[i].object;
        glm::vec3 first = radiance;
        if (object >= 0) {
            const glm::vec2 offset = sample_offset(pixel, sample, settings_);
            first = seen(glm::vec2(pixel) + 0.5F + offset, object, radiance);
        }
        sum.error += radiance - first;
        sum.square += squared(mean(radiance - first));
        if (sum.looks == 0 || sample <= looks_ahead) return;
        sum.base += first;
        sum.covered += object >= 0 ? 1.0F : 0.0F;
        ++sum.looks;
    });
}

std::vector<glm::vec4> ProgressivePicture::resolve() const {
    std::vector<glm::vec4> result(std::size_t(rect_.size().x) * rect_.size().y);
    const std::vector<Estimate> found = drawn_ > 0 ? estimates() : std::vector<Estimate>{};
    for_each_pixel(rect_, [&](glm::ivec2 pixel) {
        const std::size_t i = first_.place(pixel.x, pixel.y);
        glm::vec3 radiance = first_.radiance[i];
        float covered = first_.surfaces[i].object >= 0 ? 1.0F : 0.0F;
        if (drawn_ > 0) {
            const Pixel& sum = pixels_[place(pixel)];
            radiance = corrected(pixel, found);
            covered = sum.covered / static_cast<float>(std::max(sum.looks, 1));
        }
        const glm::ivec2 inside = pixel - rect_.begin;
        result[std::size_t(inside.y) * rect_.size().x + inside.x] =
            glm::vec4(radiance, settings_.transparent ? covered : 1.0F);
    });
    return result;
}

std::vector<glm::vec4> ProgressivePicture::normal_depth() const {
    std::vector<glm::vec4> result;
    for (int y = rect_.begin.y; y < rect_.end.y; ++y) {
        for (int x = rect_.begin.x; x < rect_.end.x; ++x) {
            const Surface& surface = first_.surfaces[first_.place(x, y)];
            result.emplace_back(surface.normal, surface.depth);
        }
    }
    return result;
}

// Brightness is that of the pixel and of the window around it, so that neither a lamp nor the dark beside it
// decides alone how much a window is believed.
std::vector<ProgressivePicture::Estimate> ProgressivePicture::estimates() const {
    std::vector<Estimate> result(pixels_.size());
    const auto light = [this](const Pixel& pixel) {
        return mean(pixel.base) / static_cast<float>(std::max(pixel.looks, 1));
    };
    for_each_pixel(drawn_rect_, [&](glm::ivec2 pixel) {
        const Pixel& sum = pixels_[place(pixel)];
        float window = 0.0F;
        float count = 0.0F;
        for_each_neighbour(pixel, window_reach, drawn_rect_, [&](glm::ivec2 other) {
            const Pixel& neighbour = pixels_[place(other)];
            if (neighbour.object != sum.object) return;
            window += light(neighbour);
            count += 1.0F;
        });
        const float scale = 1.0F / std::max(light(sum) + window / count, 1e-12F);
        const float share = 1.0F / static_cast<float>(drawn_);
        result[place(pixel)] = {sum.object, scale, scale * light(sum), share * scale * sum.error,
                                share * scale * scale * sum.square};
    });
    return result;
}

// What the first sample shows, and as much of its error as is believed.
glm::vec3 ProgressivePicture::corrected(glm::ivec2 pixel, const std::vector<Estimate>& estimates) const {
    const Pixel& sum = pixels_[place(pixel)];
    const glm::vec3 base = sum.base / static_cast<float>(std::max(sum.looks, 1));
    if (sum.object < 0) return base;
    const Estimate& own = estimates[place(pixel)];
    glm::vec3 error(0.0F);
    float squared_errors = 0.0F;
    float noise = 0.0F;
    float count = 0.0F;
    for_each_neighbour(pixel, window_reach, drawn_rect_, [&](glm::ivec2 other) {
        const Estimate& estimate = estimates[place(other)];
        if (estimate.object != own.object) return;
        error += estimate.error;
        squared_errors += squared(mean(estimate.error));
        noise += estimate.square;
        count += 1.0F;
    });
    error /= count;
    // Of a mean over samples. Squares about 0 stand in for the variance, which few samples tell too low.
    noise /= count * static_cast<float>(drawn_);
    const float own_noise = std::max(noise, own.square / static_cast<float>(drawn_));
    const float least = squared(possible_error * own.light) + 1e-12F;

    const float of_window = std::max(squared(mean(error)) - noise / count, least);
    const float inside_window =
        drawn_ > 1 ? std::max(squared_errors / count - squared(mean(error)) - noise, least) : least;
    const glm::vec3 correction =
        believed(of_window, noise / count) * error + believed(inside_window, own_noise) * (own.error - error);
    return glm::max(base + correction / own.scale, 0.0F);
}

}  // namespace verglas
