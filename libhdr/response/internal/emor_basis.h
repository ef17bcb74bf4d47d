#pragma once
// The published numbers of [Grossberg04].
#include <array>

namespace hdr {

constexpr int kEmorComponents = 7;
constexpr int kEmorSamples = 73;

/// A row of the basis: the mean response f0 and the components h_1 .. h_7 at one exposure. Exposure 1 saturates.
struct EmorSample {
  double exposure, mean;
  std::array<double, kEmorComponents> components;
};

extern const std::array<EmorSample, kEmorSamples> kEmorBasis;

}  // namespace hdr
