// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace verglas {

// An equirectangular picture of the light from far away; orientation as model::environment_uv. Immutable.
class EnvironmentMap {
  public:
    // pixels: width x height linear RGB, row 0 at the bottom. NaN and negative values become 0, infinite ones
    // the map's greatest finite value, with a warning. Throws Error when the sizes don't fit.
    EnvironmentMap(std::string name, int width, int height, std::vector<glm::vec3> pixels);

    // Reads any file that OpenImageIO knows. srgb: its values are sRGB-encoded. Throws Error with the path.
    static std::shared_ptr<const EnvironmentMap> load(const std::string& path, bool srgb);

    const std::string& name() const { return name_; }
    int width() const { return width_; }
    int height() const { return height_; }
    const std::vector<glm::vec3>& pixels() const { return pixels_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

    // The map with twice as many columns as rows, each texel the mean over its solid angle. Keeps the
    // integral over the sphere.
    std::vector<glm::vec3> resampled(int columns) const;

  private:
    void clean();

    std::string name_;
    int width_;
    int height_;
    std::vector<glm::vec3> pixels_;
    std::vector<std::string> warnings_;
};

}  // namespace verglas
