#include "libhdr/io/internal/half_rows.h"

#include <half.h>

#include <algorithm>
#include <cmath>

#ifdef __x86_64__
#include <cpuid.h>
#include <immintrin.h>
#endif

namespace hdr::internal {
namespace {

#ifdef __x86_64__
// Highway 1.0 rounds by itself where F16C is absent, and not to even: the bytes would depend on the machine.
__attribute__((target("avx,f16c"))) std::size_t convert_eights(const float* from, std::uint16_t* to,
                                                               std::size_t count) {
  std::size_t k = 0;
  for (; k + 8 <= count; k += 8) {
    const __m128i halves = _mm256_cvtps_ph(_mm256_loadu_ps(from + k), _MM_FROUND_TO_NEAREST_INT);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to + k), halves);
  }
  return k;
}

/// The system saves the wide registers (what "avx" asks), and the processor converts. Clang 14 cannot ask for "f16c".
bool has_f16c() {
  unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
  return __builtin_cpu_supports("avx") && __get_cpuid(1, &eax, &ebx, &ecx, &edx) && (ecx & bit_F16C);
}
#endif

}  // namespace

void halves_from_floats_portably(const float* from, std::uint16_t* to, std::size_t count) {
  std::transform(from, from + count, to, [](float v) { return half(v).bits(); });
}

void halves_from_floats(const float* from, std::uint16_t* to, std::size_t count) {
  std::size_t done = 0;
#ifdef __x86_64__
  static const bool fast = has_f16c();
  if (fast) done = convert_eights(from, to, count);
#endif
  halves_from_floats_portably(from + done, to + done, count - done);
}

Misfit beyond_half(const float* samples, int width, int channels) {
  Misfit misfit;
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
  bool all_fit = true;
  for (std::size_t k = 0; k < count; ++k) all_fit &= std::abs(samples[k]) <= kHalfMax;
  if (all_fit) return misfit;  // `largest` is for the message alone
  for (int x = 0; x < width; ++x) {
    bool fits = true;
    for (int c = 0; c < channels; ++c) {
      const float v = std::abs(samples[x * channels + c]);
      if (!(v <= kHalfMax)) fits = false;
      misfit.largest = std::max(misfit.largest, v);
    }
    if (!fits) ++misfit.pixels;
  }
  return misfit;
}

}  // namespace hdr::internal
