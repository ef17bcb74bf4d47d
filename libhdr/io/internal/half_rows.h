#pragma once
#include <cstddef>
#include <cstdint>

namespace hdr::internal {

inline constexpr float kHalfMax = 65504;

/// To the nearest half, ties to even; beyond kHalfMax to infinity. The same bits on every machine.
void halves_from_floats(const float* from, std::uint16_t* to, std::size_t count);

/// The same without the processor's own instruction.
void halves_from_floats_portably(const float* from, std::uint16_t* to, std::size_t count);

/// Pixels of which a sample is beyond half's range or not a number, and the largest sample.
struct Misfit {
  std::int64_t pixels = 0;
  float largest = 0;
};
Misfit beyond_half(const float* samples, int width, int channels);

}  // namespace hdr::internal
