#pragma once
// How much light a shot let in. The relative exposure is H = t (ISO/100) / N^2 2^-nd: seconds t, f-number N, and nd
// stops of neutral density. Only ratios of H inside a bracket matter until a map is calibrated absolutely.
#include <cmath>
#include <optional>

namespace hdr {

struct Exposure {
  std::optional<double> seconds;   ///< shutter time; absent when neither EXIF nor the user said it
  std::optional<double> f_number;  ///< absent: a lens without aperture data, taken as constant in the bracket
  std::optional<double> iso;       ///< absent: taken as constant in the bracket
  double nd_stops = 0;             ///< neutral density in stops

  /// H, with an absent aperture or ISO counted as 1 and 100. Absent seconds give nullopt.
  std::optional<double> relative() const {
    if (!seconds) return std::nullopt;
    const double n = f_number.value_or(1.0);
    return *seconds * (iso.value_or(100.0) / 100.0) / (n * n) * std::exp2(-nd_stops);
  }
};

}  // namespace hdr
