#pragma once
// The set with which light on a film set is judged: a grey ball, a chrome ball and a colour chart.
#include <array>

#include "libhdr/render/scene.h"

namespace hdr {

/// The 24 patches of the ColorChecker [McCamy76], row by row from dark skin to black, as linear Rec. 709 reflectance,
/// from the sRGB values that its maker publishes [XRite12].
std::array<Rgbf, 24> colour_checker();

/// A ball of 18 % grey, the chart with its first row at the top, and a chrome ball, on a plane that catches their
/// shadows (Material::shadow_catcher). The camera looks along -X, as in spheres_on_plane().
Scene colour_chart_set();

}  // namespace hdr
