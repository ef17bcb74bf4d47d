#pragma once
// Random numbers as a function of their address (seed, stream, index): the same picture for any number of threads and
// any order of work. The generator is PCG-XSH-RR 64/32 [ONeill14], its start hashed with the finaliser of SplitMix64.
#include <cmath>
#include <cstdint>
#include <numbers>

namespace hdr {

inline std::uint64_t hash64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index = 0)
      : state_(hash64(seed ^ hash64(stream ^ hash64(index)))), increment_(hash64(stream + 0x632be59bd9b4e019ULL) | 1) {}

  std::uint32_t bits() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto xorshifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto rotation = static_cast<std::uint32_t>(old >> 59);
    return (xorshifted >> rotation) | (xorshifted << ((32 - rotation) & 31));
  }

  /// Uniform in [0, 1).
  float uniform_float() { return static_cast<float>(bits() >> 8) * 0x1p-24f; }
  double uniform() {
    const std::uint64_t high = bits();
    return static_cast<double>((high << 21) ^ (bits() >> 11)) * 0x1p-53;
  }

  /// Standard normal (Box-Muller, one of the pair).
  double normal() {
    const double u = 1.0 - uniform();  // (0, 1]
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
  std::uint64_t increment_;
};

}  // namespace hdr
