// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tracing/progressive_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/pixel_filter.h"
#include "core/tracing/surface_average.h"

namespace verglas {
namespace {

// Looks through each pixel at an object's edge; these only need a ray.
constexpr int looks_ahead = 16;

// The window's pixels to each side. Of 1 to 4, least error on monkey, sphere and bottle from 1 to 256
// samples.
constexpr int window_reach = 2;

// What is thought of a window is what windows around say, from so far away to each side, one every step
// pixels: where few drawn rays in a hundred pixels meet the sun, windows that have met it are brighter than
// they should be and the others darker. From 5 to 12, further ones smooth more and blur more of the light
// between facets.
constexpr int surroundings_reach = 9;
constexpr int surroundings_step = window_reach + 1;  // whose tents then add up to a constant

// What a mean error must exceed, in variances of its noise, to be believed: rare bright samples, of which few
// windows have two, would else show.
constexpr float significance = 4.0F;

// Standard deviation of the first sample's error, as a share of its light, that is always thought possible:
// what many drawn samples agree on is then believed, however well the first sample does all around.
constexpr float possible_error = 0.05F;

// The first sample's share of a window's light below which the drawn samples tell how bright the window is:
// where it shows nothing, errors in units of its brightness would be without bound.
constexpr float least_known_share = 0.25F;

float mean(const glm::vec3& v) { return (v.x + v.y + v.z) / 3.0F; }

float squared(float x) { return x * x; }

Rect grown(const Rect& rect, int margin, glm::ivec2 frame) {
    return Rect{rect.begin - margin, rect.end + margin}.intersected({glm::ivec2(0), frame});
}

// Whole pixels that sample_offset() reaches to each side.
int filter_reach(const Settings& settings) {
    return std::max(static_cast<int>(std::ceil(settings.filter_width - 0.5F)), 0);
}

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

// Variance of errors whose mean over pixels is this; least: what is thought possible.
float variance_of(const glm::vec3& error, float noise, float least) {
    return std::max(squared(mean(error)) - significance * noise, least);
}

// Of a pixel in a window around another: falls off to the window's borders, which would be seen.
float tent(glm::ivec2 offset, int reach) {
    const glm::ivec2 nearness = reach + 1 - glm::abs(offset);
    return static_cast<float>(nearness.x * nearness.y);
}

}  // namespace

// What is known of a pixel, as means over samples. Errors count in units of its brightness and its window's,
// so that neither a lamp nor the dark beside it decides alone.
struct ProgressivePicture::Estimate {
    int object;
    float unit;
    float light;      // the first sample's, in units
    glm::vec3 error;  // in units
    float square;     // in units squared
};

// Means over the pixels around one that show its object.
struct ProgressivePicture::Window {
    int object;
    glm::vec3 error;       // in units
    float squared_errors;  // of the mean over channels
    float noise;           // variance of a pixel's error by chance
    float error_noise;     // of the window's
};

template <typename Value>
struct ProgressivePicture::Raster {
    template <typename Make>
    Raster(const Rect& rectangle, Make make) : rect(rectangle) {
        values.reserve(rect.pixels());
        for_each_pixel(rect, [&](glm::ivec2 pixel) { values.push_back(make(pixel)); });
    }
    const Value& at(glm::ivec2 pixel) const { return values[rect.place(pixel)]; }

    Rect rect;
    std::vector<Value> values;
};

// A pixel's surroundings hold windows, these estimates, which look at windows of their own. Pixels of
// drawn_rect() look for neighbours of the pixels that they see, which are averages of theirs.
void ProgressivePicture::begin(const Rect& rect, const Settings& settings) {
    settings_ = settings;
    rect_ = rect;
    drawn_rect_ =
        settings.samples > 1 ? grown(rect, surroundings_reach + 2 * window_reach, settings.size) : rect;
    reach_ = filter_reach(settings);
    first_.begin(grown(drawn_rect_, reach_ + 2, settings.size));
    averaged_.resize(first_.rect.pixels());
    pixels_.resize(settings.samples > 1 ? drawn_rect_.pixels() : 0);
    kernel_.clear();
    for (int i = -reach_; i <= reach_; ++i)
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

void ProgressivePicture::resolve_first(const Rect& tile, const BundleTracer& tracer, Frame& frame) const {
    const bool has_edges = has_edge(tile);
    for_each_pixel(tile, [&](glm::ivec2 pixel) {
        if (!has_edges || !is_edge(pixel))
            return resolve_pixel(pixel, shown(pixel), surface(pixel).object >= 0 ? 1.0F : 0.0F, frame);
        Pixel edge{};
        edge.object = surface(pixel).object;
        look_through(pixel, tracer, edge);
        resolve_pixel(pixel, edge.base / static_cast<float>(edge.looks), edge.mean_covered(), frame);
    });
}

bool ProgressivePicture::is_edge(glm::ivec2 pixel) const { return has_edge({pixel, pixel + 1}); }

// Whether the pixel filter, somewhere in a part, may see more than one object.
bool ProgressivePicture::has_edge(const Rect& part) const {
    const int object = surface(part.begin).object;
    const Rect around = Rect{part.begin - reach_, part.end + reach_}.intersected(first_.rect);
    for (int y = around.begin.y; y < around.end.y; ++y) {
        const Surface* row = &surface({around.begin.x, y});
        for (int i = 0; i < around.size().x; ++i)
            if (row[i].object != object) return true;
    }
    return false;
}

void ProgressivePicture::look_through(glm::ivec2 pixel, const BundleTracer& tracer, Pixel& result) const {
    std::array<glm::vec2, looks_ahead> places;
    for (int i = 0; i < looks_ahead; ++i)
        places[i] = glm::vec2(pixel) + 0.5F + sample_offset(pixel, i + 1, settings_);
    std::array<BundleTracer::Sight, looks_ahead> sights;
    tracer.look(places, sights);
    for (int i = 0; i < looks_ahead; ++i) {
        const auto& [object, background] = sights[i];
        if (result.object < 0) result.object = object;
        result.covered += object >= 0 ? 1.0F : 0.0F;
        result.base += object >= 0 ? seen(places[i], object, glm::vec3(0.0F)) : background;
    }
    result.looks = result.looks_ahead = looks_ahead;
}

// What the first sample shows in the mean. Inside of objects it passes a part of the pixel filter: it is
// smooth already, and with the filter farther from the truth by itself, but what the mean of many drawn
// samples is compared with needs it.
glm::vec3 ProgressivePicture::base(glm::ivec2 pixel) const {
    const Pixel& sum = known(pixel);
    if (sum.looks > 0) return sum.base / static_cast<float>(sum.looks);
    const float filtered_part = drawn_samples_ / (drawn_samples_ + 1.0F);
    return glm::mix(shown(pixel), sum.base, filtered_part);
}

// What the pixel filter makes of the first sample.
glm::vec3 ProgressivePicture::filtered(glm::ivec2 pixel) const {
    glm::vec3 sum(0.0F);
    float weights = 0.0F;
    for_each_neighbour(pixel, reach_, first_.rect, [&](glm::ivec2 other) {
        const glm::ivec2 offset = other - pixel + reach_;
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
    const Rect around = grown(tile, surroundings_reach, settings_.size);
    const Raster<Estimate> estimates(grown(around, window_reach, settings_.size),
                                     [&](glm::ivec2 pixel) { return estimate(pixel); });
    const Raster<Window> windows(around, [&](glm::ivec2 pixel) { return window(pixel, estimates); });
    for_each_pixel(tile, [&](glm::ivec2 pixel) {
        resolve_pixel(pixel, corrected(pixel, estimates, windows), known(pixel).mean_covered(), frame);
    });
}

void ProgressivePicture::resolve_pixel(glm::ivec2 pixel, const glm::vec3& radiance, float covered,
                                       Frame& frame) const {
    const std::size_t place = rect_.place(pixel);
    frame.combined[place] =
        glm::vec4(radiance, 1.0F - (1.0F - covered) * (1.0F - settings_.background_alpha));
    frame.normal_depth[place] = glm::vec4(surface(pixel).normal, surface(pixel).depth);
}

ProgressivePicture::Estimate ProgressivePicture::estimate(glm::ivec2 pixel) const {
    const Pixel& sum = known(pixel);
    const float share = 1.0F / drawn_samples_;
    float first = 0.0F;
    float drawn = 0.0F;
    float count = 0.0F;
    for_each_neighbour(pixel, window_reach, drawn_rect_, [&](glm::ivec2 other) {
        if (known(other).object != sum.object) return;
        const glm::vec3 base = this->base(other);
        first += mean(base);
        drawn += mean(base + share * known(other).error);
        count += 1.0F;
    });
    const float light = mean(base(pixel));
    const float unit = std::max(light + std::max(first, least_known_share * drawn) / count, 1e-12F);
    return {sum.object, unit, light / unit, share / unit * sum.error, share / squared(unit) * sum.square};
}

// Squares about 0 stand in for variances of samples, which few of them tell too low.
ProgressivePicture::Window ProgressivePicture::window(glm::ivec2 pixel,
                                                      const Raster<Estimate>& estimates) const {
    Window sum{.object = estimates.at(pixel).object,
               .error = glm::vec3(0.0F),
               .squared_errors = 0.0F,
               .noise = 0.0F,
               .error_noise = 0.0F};
    float weights = 0.0F;
    for_each_neighbour(pixel, window_reach, estimates.rect, [&](glm::ivec2 other) {
        const Estimate& estimate = estimates.at(other);
        if (estimate.object != sum.object) return;
        const float weight = tent(other - pixel, window_reach);
        sum.error += weight * estimate.error;
        sum.squared_errors += weight * squared(mean(estimate.error));
        sum.noise += weight * estimate.square;
        sum.error_noise += weight * weight * estimate.square;
        weights += weight;
    });
    sum.error /= weights;
    sum.squared_errors /= weights;
    sum.noise /= weights * drawn_samples_;
    sum.error_noise /= squared(weights) * drawn_samples_;
    return sum;
}

// The same of the windows around.
ProgressivePicture::Window ProgressivePicture::surroundings(glm::ivec2 pixel,
                                                            const Raster<Window>& windows) const {
    constexpr int steps = surroundings_reach / surroundings_step;
    Window sum{.object = windows.at(pixel).object,
               .error = glm::vec3(0.0F),
               .squared_errors = 0.0F,
               .noise = 0.0F,
               .error_noise = 0.0F};
    float weights = 0.0F;
    for_each_pixel(Rect{glm::ivec2(-steps), glm::ivec2(steps + 1)}, [&](glm::ivec2 step) {
        const glm::ivec2 other = pixel + surroundings_step * step;
        if (!windows.rect.contains(other) || windows.at(other).object != sum.object) return;
        const Window& one = windows.at(other);
        const float weight = tent(step, steps);
        sum.error += weight * one.error;
        sum.noise += weight * one.error_noise;
        sum.error_noise += squared(weight) * one.error_noise;
        weights += weight;
    });
    sum.error /= weights;
    sum.noise /= weights;
    sum.error_noise /= squared(weights);
    return sum;
}

// What the first sample shows, and as much of its error as is believed: of the surroundings, of how the
// window differs from them, and of how the pixel differs from its window. Each is what is thought of the next
// before its own samples are looked at.
glm::vec3 ProgressivePicture::corrected(glm::ivec2 pixel, const Raster<Estimate>& estimates,
                                        const Raster<Window>& windows) const {
    const glm::vec3 base = this->base(pixel);
    if (known(pixel).object < 0) return base;
    const Estimate& own = estimates.at(pixel);
    const Window& window = windows.at(pixel);
    const Window around = surroundings(pixel, windows);
    constexpr float tiny = 1e-12F;
    const float least = squared(possible_error * own.light) + tiny;

    glm::vec3 correction =
        believed(variance_of(around.error, around.error_noise, tiny), around.error_noise) * around.error;
    const glm::vec3 of_window = window.error - correction;
    const float window_noise = std::max(window.error_noise, around.noise);
    correction += believed(variance_of(of_window, window_noise, least), window_noise) * of_window;

    const float inside_window =
        drawn_samples_ > 1.0F
            ? std::max(window.squared_errors - squared(mean(window.error)) - window.noise, least)
            : least;
    const float own_noise = std::max(window.noise, own.square / drawn_samples_);
    correction += believed(inside_window, own_noise) * (own.error - correction);
    return glm::max(base + own.unit * correction, 0.0F);
}

}  // namespace verglas
