#pragma once
// Linear light -> 8-bit sRGB, for looking. All take three channels, exposure in stops, and `alpha`, which may be empty
// and else becomes the fourth channel.
#include <cstdint>
#include <optional>
#include <string>

#include "libhdr/core/image.h"

namespace hdr {

/// Stops that bring the picture's log-average luminance to 18 % grey [Reinhard02 eq. 1]; 0 for a black picture.
double metered_stops(View<const float> rgb);

enum class ToneOperator {
  kReinhard,  ///< a shoulder that keeps highlights apart [Reinhard02] eq. 4, white at the 99.9 % luminance; colours
              ///< keep their ratios
  kFilmic,    ///< a film's toe and shoulder, channel by channel: highlights turn white [Hable10]
  kLocal,  ///< large differences of light are compressed, details stay [Durand02]: a bilateral filter of log luminance
  kClip,   ///< none: what is above 1 is white
};
/// "reinhard", "filmic", "local" (or "bilateral"), "clip"; nullopt for any other text.
std::optional<ToneOperator> tone_operator_from_name(const std::string& name);

Image<std::uint8_t> tonemap(View<const float> rgb, double stops, View<const float> alpha = {},
                            ToneOperator tone = ToneOperator::kReinhard);

/// Luminance as colour, one a stop, and a legend below the picture: stops from 18 % grey after the exposure. The
/// colours span the stops between the 0.1 % and 99.9 % luminances; `range` says which were used. Black is below all of
/// them.
struct FalseColour {
  Image<std::uint8_t> picture;
  int lowest = 0, highest = 0;  ///< stops from grey; one colour for [lowest, lowest + 1) and so on
};
FalseColour false_colour(View<const float> rgb, double stops);

}  // namespace hdr
