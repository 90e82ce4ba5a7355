// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace verglas {

// What a texture holds beyond its borders.
enum class Extension { Repeat, Extend, Clip };

// What a texture holds between the centres of its texels.
enum class Interpolation { Linear, Closest };

// A picture over UV in [0, 1]^2, row 0 at v = 0. Immutable.
template <typename Value>
class TextureOf {
  public:
    // values: width x height. Throws Error where that isn't so. is_atlas: whether texels that are neighbours
    // need not be so on the surface; then no means of them are looked up.
    TextureOf(std::string name, int width, int height, std::vector<Value> values, Extension extension,
              Interpolation interpolation = Interpolation::Linear, bool is_atlas = false);

    const std::string& name() const { return name_; }
    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<Value>& values() const { return values_; }
    Extension extension() const { return extension_; }
    Interpolation interpolation() const { return interpolation_; }
    bool is_atlas() const { return is_atlas_; }
    // Of all values, by component.
    const Value& least() const { return least_; }
    const Value& greatest() const { return greatest_; }

    // Clip is 0 outside.
    Value sample(glm::vec2 uv) const;

  private:
    Value texel(int x, int y) const;
    Value closest(glm::vec2 uv) const;
    Value bilinear(glm::vec2 uv) const;

    std::string name_;
    int width_;
    int height_;
    std::vector<Value> values_;
    Extension extension_;
    Interpolation interpolation_;
    bool is_atlas_;
    Value least_;
    Value greatest_;
};

// Of single values.
using Texture = TextureOf<float>;
// Of vectors.
using VectorTexture = TextureOf<glm::vec3>;

// How a texture rises along u and v, by its difference over the width of a texel.
glm::vec2 slope(const Texture& texture, glm::vec2 uv);

}  // namespace verglas
