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

// A picture of single values over UV in [0, 1]^2, row 0 at v = 0. Immutable.
class Texture {
  public:
    // values: width x height. Throws Error where that isn't so.
    Texture(std::string name, int width, int height, std::vector<float> values, Extension extension,
            Interpolation interpolation = Interpolation::Linear);

    const std::string& name() const { return name_; }
    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<float>& values() const { return values_; }
    Extension extension() const { return extension_; }
    Interpolation interpolation() const { return interpolation_; }

    // Clip is 0 outside.
    float sample(glm::vec2 uv) const;

  private:
    float texel(int x, int y) const;
    float closest(glm::vec2 uv) const;
    float bilinear(glm::vec2 uv) const;

    std::string name_;
    int width_;
    int height_;
    std::vector<float> values_;
    Extension extension_;
    Interpolation interpolation_;
};

}  // namespace verglas
