#pragma once
// What nobody expects of pictures, numbers and directions, as generators for RapidCheck. Images do not copy, so what is
// generated is a plan, which is also what a failure shows; pictures are made from it.
#include <gtest/gtest.h>  // before rapidcheck/gtest.h, which takes it for granted
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "libhdr/core/image.h"
#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/response.h"

namespace hdr::stress {

/// Evenly in the exponent between 10^low and 10^high; both ends and 1 more often than by chance.
rc::Gen<double> power_of_ten(double low, double high);

/// Unit directions: anywhere, poles, the seam of a lat-long (-Z), axes, and within 1e-16 .. 1e-3 of them.
rc::Gen<Vec3> direction();

enum class Light {
  kConstant,      ///< one value
  kSpread,        ///< 1e-12 .. 1e12, evenly in the exponent
  kOneHot,        ///< black but for one sample of 1e12
  kDenormal,      ///< below the smallest normal float, and zeros
  kCheckerboard,  ///< 1e-12 beside 1e12
  kPedestal,      ///< 1e6 and small waves on it: differences lose seven digits
  kBlack,
  kSun,  ///< of the order of 1, and a pixel of 1e9
};

struct MapPlan {
  int width = 1, height = 1;
  Light light = Light::kConstant;
  std::uint64_t seed = 0;
};
std::ostream& operator<<(std::ostream& out, const MapPlan& plan);

/// Three channels, finite, not negative.
Image<float> made(const MapPlan& plan);
/// 1x1, single rows and columns, primes, powers of two; none larger than `largest` either way.
rc::Gen<MapPlan> any_map(int largest = 40);
/// Twice as wide as high.
rc::Gen<MapPlan> any_latlong(int largest_width = 64);

/// NaN, infinities, negative light and negative zero in every third sample.
void spoil(Image<float>& map, std::uint64_t seed);

/// A bracket that a camera could write and nobody would take.
struct BracketCase {
  int width = 1, height = 1, shots = 2, bits = 8;
  double stops_apart = 1;  ///< up to 2^40 in all
  int kind = 0;            ///< of bracket_kinds
  bool lossy = false;
  std::uint64_t seed = 0;
};
inline const std::vector<std::string> bracket_kinds = {"photographed", "all black", "all clipped",       "one code",
                                                       "random codes", "two codes", "brighter is darker"};
std::ostream& operator<<(std::ostream& out, const BracketCase& plan);
Bracket made(const BracketCase& plan);
rc::Gen<BracketCase> any_bracket(int largest = 24);

/// Finite and not negative, all of it: the first sample that is not, in words; empty when there is none.
std::string fault_of(View<const float> map);

double smallest_of(View<const float> map);
double largest_of(View<const float> map);

}  // namespace hdr::stress
