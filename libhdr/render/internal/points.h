#pragma once
// Well-spread points in the unit square, as a function of their address.
#include <cmath>
#include <cstdint>

#include "libhdr/core/random.h"
#include "libhdr/core/vec.h"

namespace hdr {

/// Where a random number is used: no two uses share one.
inline std::uint64_t address(std::uint64_t seed, std::uint64_t pixel, std::uint64_t group, std::uint64_t use) {
  return hash64(seed ^ hash64(pixel ^ hash64((group << 8) | use)));
}

inline std::uint32_t reversed_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
}

/// Owen's nested scramble of the binary digits of x, first digit highest: each digit is flipped by a hash of those
/// before it. On reversed digits that is a hash in which bits only affect higher ones [Burley20].
inline std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
  x = reversed_bits(x);
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return reversed_bits(x);
}

/// The digits of a point of Sobol's (0,2)-sequence, the first of them highest.
struct SobolDigits {
  explicit SobolDigits(std::uint32_t which) : index(which), x(reversed_bits(which)) {
    for (std::uint32_t rest = index, column = 0x80000000u; rest != 0; rest >>= 1, column ^= column >> 1)
      if (rest & 1) y ^= column;
  }
  std::uint32_t index, x, y = 0;
};

/// Owen-scrambled: for any power of two of points, each elementary interval of that area holds one. Below the 32
/// scrambled digits the points go on at random, to 53.
inline Vec2 scrambled(const SobolDigits& digits, std::uint64_t seed) {
  const std::uint32_t x = owen_scramble(digits.x, static_cast<std::uint32_t>(seed));
  const std::uint32_t y = owen_scramble(digits.y, static_cast<std::uint32_t>(seed >> 32));
  const std::uint64_t tail = hash64(seed + digits.index);
  const auto joined = [](std::uint32_t high, std::uint64_t low) {
    return static_cast<double>((static_cast<std::uint64_t>(high) << 21) | (low & 0x1fffff)) * 0x1p-53;
  };
  return {joined(x, tail), joined(y, tail >> 32)};
}

inline Vec2 sobol_point(std::uint32_t index, std::uint64_t seed) {
  return scrambled(SobolDigits(index), seed);
}

/// The lecture's eq. 9: `count` points as M x N jittered strata, point k in stratum (k / N, k mod N); M is the largest
/// divisor that is not above N.
inline Vec2 stratified_point(int k, int count, std::uint64_t seed) {
  int m = static_cast<int>(std::sqrt(static_cast<double>(count)));
  while (count % m != 0) --m;
  const int n = count / m;
  Random random(seed, static_cast<std::uint64_t>(k));
  const double xi1 = random.uniform(), xi2 = random.uniform();
  return {(k / n + xi1) / m, (k % n + xi2) / n};
}

}  // namespace hdr
