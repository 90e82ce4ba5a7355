// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace verglas {

// One point of a Sobol sequence with Owen scrambling (Burley 2020, "Practical Hash-based Owen Scrambling"),
// its own scrambling for every pixel and seed. Through smooth lobes, means over the first 2^k points converge
// several times faster than over random ones. The point depends on (pixel, sample, seed) alone, whatever
// thread asks.
class SobolPoint {
  public:
    SobolPoint(std::uint64_t pixel, std::uint32_t sample, std::uint64_t seed);

    // Coordinate `dimension` >= 0, in [0, 1). Each run of sobol_dimensions coordinates is well distributed
    // jointly; the runs are independent of each other.
    float operator[](int dimension) const;
    glm::vec2 pair(int dimension) const { return {(*this)[dimension], (*this)[dimension + 1]}; }

    // Point k of the `count` in a row that stand for this one where its sample is split.
    SobolPoint part(std::uint32_t k, std::uint32_t count) const {
        SobolPoint result = *this;
        result.sample_ = sample_ * count + k;
        return result;
    }

  private:
    std::uint32_t sample_;
    std::uint64_t seed_;
};

constexpr int sobol_dimensions = 16;

// Coordinate `dimension` < sobol_dimensions of point `index` of the sequence without scrambling, times 2^32.
std::uint32_t sobol_coordinate(std::uint32_t index, int dimension);

}  // namespace verglas
