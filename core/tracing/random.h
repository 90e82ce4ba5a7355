// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace verglas {

// Random numbers that depend on (pixel, sample, seed) alone, whatever thread draws them: PCG32 (O'Neill
// 2014), started from hashed indices.
class Random {
  public:
    Random(std::uint64_t pixel, std::uint64_t sample, std::uint64_t seed)
        : state_(hash(hash(hash(seed) + pixel) + sample)) {
        next();
    }

    // In [0, 1).
    float uniform() { return static_cast<float>(next() >> 8) * 0x1p-24F; }
    glm::vec2 uniform2() {
        const float x = uniform();
        return {x, uniform()};
    }

  private:
    std::uint32_t next() {
        const std::uint64_t old = state_;
        state_ = old * 6364136223846793005U + 1442695040888963407U;
        const auto xorshifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
        const auto rotation = static_cast<std::uint32_t>(old >> 59U);
        return (xorshifted >> rotation) | (xorshifted << ((~rotation + 1U) & 31U));
    }

    // Finaliser of SplitMix64 (Steele, Lea, Flood 2014).
    static std::uint64_t hash(std::uint64_t x) {
        x += 0x9e3779b97f4a7c15U;
        x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
        x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
        return x ^ (x >> 31U);
    }

    std::uint64_t state_;
};

}  // namespace verglas
