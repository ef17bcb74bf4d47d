#pragma once
// The scale of a map: which unit it is merged in, and how many cd/m^2 that is. Values stay relative: what is known of
// the scale is written beside them, as hdr:exposure_unit and whiteLuminance.
#include <optional>
#include <string>

#include "libhdr/core/photometry.h"
#include "libhdr/core/radiance.h"
#include "libhdr/io/map_scale.h"
#include "tools/hdr/options.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// The scale of --scale-like's map, all absent without that option. Throws Error when the map does not say its unit.
MapScale scale_like(const ScaleFlags& flags);

/// "seconds f_number iso": what hdr:exposure_terms says of the exposures.
std::string text_from_terms(const ExposureTerms& terms);

/// Throws Error when the exposures of the two maps are made of different terms: the unit would mean two things.
void require_same_terms(const ScaleFlags& flags, const MapScale& like, const Bracket& bracket);

/// cd/m^2 of radiance 1 as far as it is known before the merge: from --cd-per-unit, the map of --scale-like, the
/// exposure formula. Nothing while --patch waits for the map, or --lux for the probe.
std::optional<double> known_white_luminance(const ScaleFlags& flags, const MapScale& like, const Bracket& bracket,
                                            double exposure_unit);

/// cd/m^2 of radiance 1 from --patch (and --lux), in the merged map. Throws Error when the patch is not in it.
double white_luminance_of_patch(Run& run, const ScaleFlags& flags, View<const float> map);

/// --lux without a patch: the horizontal irradiance of `probe` is that many lux; both maps get the white luminance.
void scale_by_lux(Run& run, const ScaleFlags& flags, RadianceMap& probe, RadianceMap& map);

/// The answer's white_luminance, when known.
void answer_white_luminance(Run& run, const std::optional<double>& white_luminance);

}  // namespace hdr::tools
