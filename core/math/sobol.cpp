// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/math/sobol.h"

#include <array>
#include <bit>

namespace verglas {
namespace {

// A primitive polynomial over GF(2), of its degree and with its inner coefficients, and the first direction
// numbers (Joe and Kuo 2008).
struct Polynomial {
    int degree;
    std::uint32_t coefficients;
    std::array<std::uint32_t, 6> m;
};

constexpr std::array<Polynomial, sobol_dimensions - 1> polynomials = {{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
}};

using Directions = std::array<std::uint32_t, 32>;

constexpr Directions directions_of(const Polynomial& polynomial) {
    Directions v{};
    const int s = polynomial.degree;
    for (int i = 0; i < 32; ++i) {
        if (i < s) {
            v[i] = polynomial.m[i] << (31 - i);
            continue;
        }
        v[i] = v[i - s] ^ (v[i - s] >> s);
        for (int k = 1; k < s; ++k) {
            if ((polynomial.coefficients >> (s - 1 - k)) & 1U) v[i] ^= v[i - k];
        }
    }
    return v;
}

constexpr std::array<Directions, sobol_dimensions> make_directions() {
    std::array<Directions, sobol_dimensions> all{};
    for (int i = 0; i < 32; ++i) all[0][i] = 1U << (31 - i);
    for (int d = 1; d < sobol_dimensions; ++d) all[d] = directions_of(polynomials[d - 1]);
    return all;
}

constexpr std::array<Directions, sobol_dimensions> directions = make_directions();

constexpr std::uint32_t reverse_bits(std::uint32_t x) {
    x = (x >> 16U) | (x << 16U);
    x = ((x & 0xff00ff00U) >> 8U) | ((x & 0x00ff00ffU) << 8U);
    x = ((x & 0xf0f0f0f0U) >> 4U) | ((x & 0x0f0f0f0fU) << 4U);
    x = ((x & 0xccccccccU) >> 2U) | ((x & 0x33333333U) << 2U);
    return ((x & 0xaaaaaaaaU) >> 1U) | ((x & 0x55555555U) << 1U);
}

// Flips every bit depending on those above it and the seed: Laine and Karras 2011, with Vegdahl's constants.
constexpr std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
    x = reverse_bits(x);
    x ^= x * 0x3d20adeaU;
    x += seed;
    x *= (seed >> 16U) | 1U;
    x ^= x * 0x05526c56U;
    x ^= x * 0x53a22864U;
    return reverse_bits(x);
}

// Finaliser of SplitMix64 (Steele, Lea, Flood 2014).
constexpr std::uint64_t hash(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
}

}  // namespace

std::uint32_t sobol_coordinate(std::uint32_t index, int dimension) {
    std::uint32_t x = 0;
    for (; index != 0; index &= index - 1) x ^= directions[dimension][std::countr_zero(index)];
    return x;
}

SobolPoint::SobolPoint(std::uint64_t pixel, std::uint32_t sample, std::uint64_t seed)
    : sample_(sample), seed_(hash(hash(seed) + pixel)) {}

float SobolPoint::operator[](int dimension) const {
    const int run = dimension / sobol_dimensions;
    std::uint32_t index = sample_;
    // Later runs take the points in another order, in which the first 2^k are 2^k consecutive ones all the
    // same.
    if (run > 0) index = owen_scramble(index, static_cast<std::uint32_t>(hash(seed_ + run)));
    const auto scramble =
        static_cast<std::uint32_t>(hash(seed_ ^ (static_cast<std::uint64_t>(dimension) << 32U)));
    const std::uint32_t x = owen_scramble(sobol_coordinate(index, dimension % sobol_dimensions), scramble);
    return static_cast<float>(x >> 8U) * 0x1p-24F;
}

}  // namespace verglas
