#pragma once
// From relative radiance to cd/m^2, by the exposure formula of reflected-light meters [ISO2720]: a scene of luminance L
// is exposed rightly when t S / N^2 = K / L, with seconds t, ISO speed S, f-number N and the meter's constant K.
#include <algorithm>
#include <optional>

#include "libhdr/core/photo.h"

namespace hdr {

/// K for L in cd/m^2. [ISO2720] allows 10.6 to 13.4; makers use 12.5 (most cameras) and 14. That range, the camera's
/// own idea of its ISO speed and the light that its lens loses leave about half a stop of doubt.
inline constexpr double kMeterConstant = 12.5;

/// cd/m^2 of what gives the middle code at relative exposure H = t (S/100) / N^2: L = K / (100 H). So it is the
/// luminance of radiance 1 in a map of exposure unit H (merge/merge.h).
constexpr double luminance_of_unit_radiance(double exposure_unit) {
  return kMeterConstant / (100 * exposure_unit);
}

/// Which of time, aperture and ISO speed the exposure is made of; what is absent was taken as constant.
struct ExposureTerms {
  bool seconds = false, f_number = false, iso = false;
  bool operator==(const ExposureTerms&) const = default;
  bool all() const { return seconds && f_number && iso; }
};

/// The terms that every shot has.
inline ExposureTerms exposure_terms(const Bracket& bracket) {
  const auto every = [&](const auto& has) {
    return !bracket.shots.empty() && std::all_of(bracket.shots.begin(), bracket.shots.end(), has);
  };
  return {every([](const Photo& shot) { return shot.exposure.seconds.has_value(); }),
          every([](const Photo& shot) { return shot.exposure.f_number.has_value(); }),
          every([](const Photo& shot) { return shot.exposure.iso.has_value(); })};
}

/// cd/m^2 of the colour (1,1,1) in a map of this unit; nothing unless time, aperture and ISO speed of every shot are
/// known.
inline std::optional<double> white_luminance(const Bracket& bracket, double exposure_unit) {
  if (!exposure_terms(bracket).all()) return std::nullopt;
  return luminance_of_unit_radiance(exposure_unit);
}

}  // namespace hdr
