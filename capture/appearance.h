#pragma once
// What a frame looks like, as far as its exposure is concerned: how often each code occurs, and the means of its tiles.
#include <cstdint>
#include <vector>

#include "capture/frame.h"

namespace hdr {

/// Which codes of a format tell how much light there was. Codes from `floor` to `ceiling` do; below is noise, above is
/// clipped. In 8 bits the floor is code 16 (of 255, less the black level), where rounding and noise are some
/// hundredths; with more bits a 512th of the range, and never less than 8 codes. The ceiling is 98 % of the range,
/// below which compression does not smear what clips.
struct UsableCodes {
  double black = 0, floor = 16, ceiling = 250, white = 255;
  bool linear = false;  ///< the sensor's own samples: codes less black are proportional to light
};
UsableCodes usable_codes(const FrameFormat& format);

/// counts[code] of one colour.
struct CodeHistogram {
  std::vector<std::uint32_t> counts;
  std::uint64_t total = 0;

  double share_below(double code) const;  ///< of samples with a code < `code`
  double share_above(double code) const;
  /// The code that a share `q` of the samples is below, between codes where they are spread evenly in each code's cell.
  double quantile(double q) const;
};

struct Appearance {
  UsableCodes usable;
  std::vector<CodeHistogram> colours;  ///< R G B, or one for a grey frame
  std::vector<float> tiles;            ///< mean green or grey codes of a grid of tiles of at least 8x8 pixels

  const CodeHistogram& green() const { return colours.size() == 3 ? colours[1] : colours[0]; }
  double clipped() const;  ///< share of the samples of all colours above the ceiling
  double dark() const;     ///< below the floor
};

/// Throws Error for bytes that are not what the format says.
Appearance appearance_of(const Frame& frame);

/// Whether two frames show the same light with the same exposure: nine of ten tiles agree within 5 % of the code or a
/// 255th of the range. A frame of which a part is of another exposure does not.
bool agree(const Appearance& a, const Appearance& b);

}  // namespace hdr
