// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/progressive_picture.h"

#include <algorithm>
#include <cmath>

#include "core/math/pixel_filter.h"
#include "core/tracing/surface_average.h"

namespace verglas {
namespace {

// Looks through each pixel at an object's edge before the first drawn sample; these only need a ray.
constexpr int looks_ahead = 16;

// The window's pixels to each side. Of 1 to 4, least error on monkey, sphere and bottle from 1 to 256
// samples.
constexpr int window_reach = 2;

// What a window's error must exceed, in variances of its noise, to be believed: rare bright samples, of which
// few windows have two, would else show as squares.
constexpr float significance = 4.0F;

// Standard deviation of the first sample's error, as a share of its light, that is always thought possible:
// what many drawn samples agree on is then believed, however well the first sample does all around.
constexpr float possible_error = 0.05F;

float mean(const glm::vec3& v) { return (v.x + v.y + v.z) / 3.0F; }

float squared(float x) { return x * x; }

Rect grown(const Rect& rect, int margin, glm::ivec2 frame) {
    return Rect{rect.begin - margin, rect.end + margin}.intersected({glm::ivec2(0), frame});
}

// Whole pixels that sample_offset() reaches to each side.
int filter_reach(const Settings& settings) { return static_cast<int>(std::round(settings.filter_width)); }

template <typename Work>
void for_each_pixel(const Rect& rect, Work work) {
    for (int y = rect.begin.y; y < rect.end.y; ++y)
        for (int x = rect.begin.x; x < rect.end.x; ++x) work(glm::ivec2(x, y));
}

template <typename Work>
void for_each_neighbour(glm::ivec2 pixel, int reach, const Rect& rect, Work work) {
    for_each_pixel(Rect{pixel - reach, pixel + reach + 1}.intersected(rect), work);
}

// The share of what an error is found to be that is believed: it has this variance where all noise is away.
float believed(float variance, float noise) { return variance / (variance + noise); }

}  // namespace

// What is known of a pixel, as means over samples.
struct ProgressivePicture::Estimate {
    int object;
    float light;   // the first sample's
    float window;  // the same, of the window
    glm::vec3 error;
    float square;
};

struct ProgressivePicture::Estimates {
    const Estimate& at(glm::ivec2 pixel) const { return values[rect.place(pixel)]; }

    Rect rect;
    std::vector<Estimate> values;
};

// A pixel's window holds estimates, which look at windows of their own. Pixels of drawn_rect() look for
// neighbours of the pixels that they see, which are averages of theirs.
ProgressivePicture::ProgressivePicture(const Rect& rect, const Settings& settings)
    : settings_(settings),
      rect_(rect),
      drawn_rect_(settings.samples > 1 ? grown(rect, 2 * window_reach, settings.size) : rect),
      first_(grown(drawn_rect_, settings.samples > 1 ? filter_reach(settings) + 2 : 1, settings.size)),
      averaged_(std::make_unique_for_overwrite<glm::vec3[]>(first_.pixels)) {
    if (settings.samples == 1) return;
    pixels_ =
        std::make_unique_for_overwrite<Pixel[]>(std::size_t(drawn_rect_.size().x) * drawn_rect_.size().y);
    const int reach = filter_reach(settings);
    for (int i = -reach; i <= reach; ++i)
        kernel_.push_back(blackman_harris_share(static_cast<float>(i) - 0.5F, static_cast<float>(i) + 0.5F,
                                                settings.filter_width));
}

void ProgressivePicture::average(const Rect& tile) {
    for_each_pixel(tile, [&](glm::ivec2 pixel) {
        averaged_[first_.place(pixel.x, pixel.y)] = average_over_surface(first_, pixel);
    });
}

void ProgressivePicture::prepare(const Rect& tile, const BundleTracer& tracer) {
    for_each_pixel(tile, [&](glm::ivec2 pixel) {
        Pixel& result = pixels_[drawn_rect_.place(pixel)] = {};
        result.object = surface(pixel).object;
        if (is_edge(pixel)) {
            look_through(pixel, tracer, result);
        } else if (result.object < 0) {
            result.base = shown(pixel);
            result.looks = 1;
        } else {
            result.base = filtered(pixel);
            result.covered = 1.0F;
        }
    });
}

bool ProgressivePicture::is_edge(glm::ivec2 pixel) const {
    bool found = false;
    for_each_neighbour(pixel, filter_reach(settings_), first_.rect,
                       [&](glm::ivec2 other) { found |= surface(other).object != surface(pixel).object; });
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
    result.looks = result.looks_ahead = looks_ahead;
}

// What the pixel filter makes of the first sample.
glm::vec3 ProgressivePicture::filtered(glm::ivec2 pixel) const {
    const int reach = filter_reach(settings_);
    glm::vec3 sum(0.0F);
    float weights = 0.0F;
    for_each_neighbour(pixel, reach, first_.rect, [&](glm::ivec2 other) {
        const glm::ivec2 offset = other - pixel + reach;
        const float weight = kernel_[offset.x] * kernel_[offset.y];
        sum += weight * shown(other);
        weights += weight;
    });
    return sum / weights;
}

// What the first sample shows of an object at a place of the frame: its nearest pixel, if one is near.
glm::vec3 ProgressivePicture::seen(glm::vec2 place, int object, const glm::vec3& otherwise) const {
    glm::vec3 nearest = otherwise;
    float least = 1e9F;
    for_each_neighbour(glm::ivec2(glm::floor(place)), 1, first_.rect, [&](glm::ivec2 pixel) {
        const glm::vec2 away = glm::vec2(pixel) + 0.5F - place;
        const float distance = glm::dot(away, away);
        if (surface(pixel).object != object || distance >= least) return;
        nearest = shown(pixel);
        least = distance;
    });
    return nearest;
}

void ProgressivePicture::add(const Rect& tile, const TracedPicture& drawn, int sample) {
    for_each_pixel(tile, [&](glm::ivec2 pixel) {
        Pixel& sum = pixels_[drawn_rect_.place(pixel)];
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
        if (sum.looks == 0 || sample <= sum.looks_ahead) return;
        sum.base += first;
        sum.covered += object >= 0 ? 1.0F : 0.0F;
        ++sum.looks;
    });
}

void ProgressivePicture::resolve(const Rect& tile, Frame& frame) const {
    Estimates estimates;
    if (settings_.samples > 1) {
        estimates.rect = grown(tile, window_reach, settings_.size);
        for_each_pixel(estimates.rect,
                       [&](glm::ivec2 pixel) { estimates.values.push_back(estimate(pixel)); });
    }
    for_each_pixel(tile, [&](glm::ivec2 pixel) {
        glm::vec3 radiance = shown(pixel);
        float covered = surface(pixel).object >= 0 ? 1.0F : 0.0F;
        if (settings_.samples > 1) {
            radiance = corrected(pixel, estimates);
            covered = known(pixel).mean_covered();
        }
        const std::size_t place = rect_.place(pixel);
        frame.combined[place] = glm::vec4(radiance, settings_.transparent ? covered : 1.0F);
        frame.normal_depth[place] = glm::vec4(surface(pixel).normal, surface(pixel).depth);
    });
}

ProgressivePicture::Estimate ProgressivePicture::estimate(glm::ivec2 pixel) const {
    const Pixel& sum = known(pixel);
    float window = 0.0F;
    float count = 0.0F;
    for_each_neighbour(pixel, window_reach, drawn_rect_, [&](glm::ivec2 other) {
        if (known(other).object != sum.object) return;
        window += mean(known(other).mean_base());
        count += 1.0F;
    });
    const float share = 1.0F / static_cast<float>(settings_.samples - 1);
    return {sum.object, mean(sum.mean_base()), window / count, share * sum.error, share * sum.square};
}

// What the first sample shows, and as much of its error as is believed. Errors of a window's pixels count in
// units of their brightness and the window's, so that neither a lamp nor the dark beside it decides alone.
glm::vec3 ProgressivePicture::corrected(glm::ivec2 pixel, const Estimates& estimates) const {
    const glm::vec3 base = known(pixel).mean_base();
    if (known(pixel).object < 0) return base;
    const Estimate& own = estimates.at(pixel);
    const auto unit = [&own](const Estimate& estimate) {
        return std::max(estimate.light + own.window, 1e-12F);
    };
    glm::vec3 error(0.0F);
    float squared_errors = 0.0F;
    float noise = 0.0F;
    float error_noise = 0.0F;
    float weights = 0.0F;
    for_each_neighbour(pixel, window_reach, drawn_rect_, [&](glm::ivec2 other) {
        const Estimate& estimate = estimates.at(other);
        if (estimate.object != own.object) return;
        // Falls off to the window's borders, which would be seen.
        const glm::ivec2 nearness = window_reach + 1 - glm::abs(other - pixel);
        const auto weight = static_cast<float>(nearness.x * nearness.y);
        const float square = estimate.square / squared(unit(estimate));
        error += weight * estimate.error / unit(estimate);
        squared_errors += weight * squared(mean(estimate.error) / unit(estimate));
        noise += weight * square;
        error_noise += weight * weight * square;
        weights += weight;
    });
    error /= weights;
    squared_errors /= weights;
    // Of a mean over samples. Squares about 0 stand in for the variance, which few samples tell too low.
    const auto drawn = static_cast<float>(settings_.samples - 1);
    noise /= weights * drawn;
    error_noise /= weights * weights * drawn;
    const float own_noise = std::max(noise, own.square / squared(unit(own)) / drawn);
    const float least = squared(possible_error * own.light / unit(own)) + 1e-12F;

    const float of_window = std::max(squared(mean(error)) - significance * error_noise, least);
    const float inside_window =
        drawn > 1.0F ? std::max(squared_errors - squared(mean(error)) - noise, least) : least;
    // What the window says is what is thought of the pixel before its own samples are looked at.
    const glm::vec3 of_all = believed(of_window, error_noise) * error;
    const glm::vec3 correction =
        of_all + believed(inside_window, own_noise) * (own.error / unit(own) - of_all);
    return glm::max(base + unit(own) * correction, 0.0F);
}

}  // namespace verglas
