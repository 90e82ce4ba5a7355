// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/scene/texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"

namespace verglas {

template <typename Value>
TextureOf<Value>::TextureOf(std::string name, int width, int height, std::vector<Value> values,
                            Extension extension, Interpolation interpolation, bool is_atlas)
    : name_(std::move(name)),
      width_(width),
      height_(height),
      values_(std::move(values)),
      extension_(extension),
      interpolation_(interpolation),
      is_atlas_(is_atlas) {
    if (width < 1 || height < 1 || values_.size() != std::size_t(width) * height)
        throw Error("Texture '" + name_ + "' has no pixels, or not as many as its size says.");
    least_ = greatest_ = values_.front();
    for (const Value& value : values_) {
        least_ = glm::min(least_, value);
        greatest_ = glm::max(greatest_, value);
    }
}

template <typename Value>
Value TextureOf<Value>::texel(int x, int y) const {
    if (extension_ == Extension::Repeat) {
        x = (x % width_ + width_) % width_;
        y = (y % height_ + height_) % height_;
    } else if (extension_ == Extension::Clip && (x < 0 || y < 0 || x >= width_ || y >= height_)) {
        return Value(0.0F);
    }
    return values_[std::size_t(std::clamp(y, 0, height_ - 1)) * width_ + std::clamp(x, 0, width_ - 1)];
}

template <typename Value>
Value TextureOf<Value>::sample(glm::vec2 uv) const {
    if (extension_ == Extension::Repeat) uv -= glm::floor(uv);
    return interpolation_ == Interpolation::Closest ? closest(uv) : bilinear(uv);
}

// Far outside all extensions are constant, and integers would overflow.

template <typename Value>
Value TextureOf<Value>::closest(glm::vec2 uv) const {
    const glm::vec2 size(width_, height_);
    const glm::ivec2 place(glm::clamp(glm::floor(uv * size), glm::vec2(-1.0F), size));
    return texel(place.x, place.y);
}

template <typename Value>
Value TextureOf<Value>::bilinear(glm::vec2 uv) const {
    const glm::vec2 size(width_, height_);
    const glm::vec2 place = glm::clamp(uv * size - 0.5F, glm::vec2(-2.0F), size + 1.0F);
    const glm::vec2 corner = glm::floor(place);
    const glm::vec2 t = place - corner;
    const int x = static_cast<int>(corner.x);
    const int y = static_cast<int>(corner.y);
    return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), t.x),
                    glm::mix(texel(x, y + 1), texel(x + 1, y + 1), t.x), t.y);
}

template class TextureOf<float>;
template class TextureOf<glm::vec3>;

glm::vec2 slope(const Texture& texture, glm::vec2 uv) {
    const glm::vec2 size(texture.width(), texture.height());
    const glm::vec2 half_u(0.5F / size.x, 0.0F);
    const glm::vec2 half_v(0.0F, 0.5F / size.y);
    return size * glm::vec2(texture.sample(uv + half_u) - texture.sample(uv - half_u),
                            texture.sample(uv + half_v) - texture.sample(uv - half_v));
}

}  // namespace verglas
