#pragma once
// Windows against ringing: a short expansion of a sun overshoots and goes below zero on the far side. A window lowers
// the high bands [Sloan08]; what it takes away is blur.
#include <optional>
#include <string>

#include "libhdr/light/sh.h"

namespace hdr {

/// kHann: (1 + cos(pi l / w)) / 2. kLanczos: sin(pi l / w) / (pi l / w). Both with w = degree + 1, the first band that
/// the expansion leaves out. kAuto: the least window after which no normal has a negative irradiance, as [Sloan17] has
/// it: sin(pi l / w)^4 / (pi l / w)^4 with the largest such w; none where nothing rings.
enum class ShWindow { kNone, kHann, kLanczos, kAuto };
std::optional<ShWindow> sh_window_from_name(const std::string& name);

struct WindowedSh {
  Sh sh;
  std::vector<double> factors;  ///< of each band, 0..1
};
WindowedSh windowed(const Sh& sh, ShWindow window);

}  // namespace hdr
