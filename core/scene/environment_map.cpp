// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/scene/environment_map.h"

#include <OpenImageIO/imageio.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "core/error.h"

namespace verglas {
namespace {

// One row or column of a resampled picture: the sources [first, first + weights.size()) and their weights.
struct Overlap {
    int first = 0;
    std::vector<double> weights;  // sum is 1
};

// How target cell `index` of `targets` covers the `sources` cells of the same interval [0, 1]; measure(a, b)
// is the size of an interval.
template <typename Measure>
Overlap overlap(int index, int targets, int sources, Measure measure) {
    const double begin = static_cast<double>(index) / targets;
    const double end = static_cast<double>(index + 1) / targets;
    Overlap result;
    result.first = std::min(static_cast<int>(begin * sources), sources - 1);
    const int last = std::clamp(static_cast<int>(std::ceil(end * sources)) - 1, result.first, sources - 1);
    double sum = 0.0;
    for (int source = result.first; source <= last; ++source) {
        const double a = std::max(begin, static_cast<double>(source) / sources);
        const double b = std::min(end, static_cast<double>(source + 1) / sources);
        result.weights.push_back(std::max(measure(a, b), 0.0));
        sum += result.weights.back();
    }
    for (double& weight : result.weights) weight /= sum;
    return result;
}

}  // namespace

EnvironmentMap::EnvironmentMap(std::string name, int width, int height, std::vector<glm::vec3> pixels)
    : name_(std::move(name)), width_(width), height_(height), pixels_(std::move(pixels)) {
    if (width < 1 || height < 1 || pixels_.size() != std::size_t(width) * height)
        throw Error("The environment map '" + name_ + "' has no pixels.");
    clean();
}

void EnvironmentMap::clean() {
    std::size_t nan = 0;
    std::size_t negative = 0;
    std::size_t infinite = 0;
    float greatest = 0.0F;
    for (const glm::vec3& pixel : pixels_) {
        for (int c = 0; c < 3; ++c) {
            if (std::isfinite(pixel[c])) greatest = std::max(greatest, pixel[c]);
        }
    }
    for (glm::vec3& pixel : pixels_) {
        for (int c = 0; c < 3; ++c) {
            float& value = pixel[c];
            if (std::isnan(value)) {
                ++nan;
                value = 0.0F;
            } else if (value < 0.0F) {
                ++negative;
                value = 0.0F;
            } else if (std::isinf(value)) {
                ++infinite;
                value = greatest;
            }
        }
    }
    if (nan + negative + infinite == 0) return;
    warnings_.push_back("The environment map '" + name_ +
                        "' has values that are no light: " + std::to_string(nan) + " NaN and " +
                        std::to_string(negative) + " negative ones are taken as 0, " +
                        std::to_string(infinite) + " infinite ones as the greatest finite one.");
}

std::shared_ptr<const EnvironmentMap> EnvironmentMap::load(const std::string& path, bool srgb) {
    // Read past OpenImageIO's cache, which would go by what a file held before it was replaced, and which
    // Blender may share.
    const auto input = OIIO::ImageInput::open(path);
    if (!input) throw Error("The environment map '" + path + "' can't be read: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    std::vector<float> values(std::size_t(spec.width) * spec.height * spec.nchannels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
        throw Error("The environment map '" + path + "' can't be read: " + input->geterror());

    const auto linear = [srgb](float v) {
        if (!srgb) return v;
        return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
    };
    std::vector<glm::vec3> pixels(std::size_t(spec.width) * spec.height);
    for (int y = 0; y < spec.height; ++y) {
        for (int x = 0; x < spec.width; ++x) {
            const float* value = &values[(std::size_t(y) * spec.width + x) * spec.nchannels];
            glm::vec3& pixel = pixels[std::size_t(spec.height - 1 - y) * spec.width + x];
            // One or two channels are grey, and grey with alpha.
            for (int c = 0; c < 3; ++c) pixel[c] = linear(value[spec.nchannels < 3 ? 0 : c]);
        }
    }
    return std::make_shared<const EnvironmentMap>(path, spec.width, spec.height, std::move(pixels));
}

std::vector<glm::vec3> EnvironmentMap::resampled(int columns) const {
    const int rows = columns / 2;
    std::vector<Overlap> across;
    across.reserve(columns);
    for (int x = 0; x < columns; ++x)
        across.push_back(overlap(x, columns, width_, [](double a, double b) { return b - a; }));
    std::vector<glm::vec3> result(std::size_t(columns) * rows);
    tbb::parallel_for(0, rows, [&](int y) {
        const Overlap down = overlap(y, rows, height_, [](double a, double b) {
            return std::cos(glm::pi<double>() * a) - std::cos(glm::pi<double>() * b);
        });
        std::vector<glm::dvec3> row(width_);
        for (std::size_t j = 0; j < down.weights.size(); ++j) {
            const glm::vec3* source = &pixels_[(down.first + j) * width_];
            for (int x = 0; x < width_; ++x) row[x] += down.weights[j] * glm::dvec3(source[x]);
        }
        for (int x = 0; x < columns; ++x) {
            glm::dvec3 sum(0.0);
            for (std::size_t i = 0; i < across[x].weights.size(); ++i)
                sum += across[x].weights[i] * row[across[x].first + i];
            result[std::size_t(y) * columns + x] = glm::vec3(sum);
        }
    });
    return result;
}

}  // namespace verglas
