#pragma once
// The data behind a response, as they are explained on a blackboard: each pixel of the scene, seen in several shots,
// shows a fragment of g at an unknown height; shifted by its ln E, all fragments lie on one curve [Debevec97, fig. 2].
#include <array>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/response.h"

namespace hdr {

/// What one place of the scene says of one channel.
struct CurveFragment {
  std::vector<double> codes;        ///< means over a small window, in rising order of exposure
  std::vector<double> ln_exposure;  ///< ln H of the shots that they come from
  double ln_radiance = 0;           ///< the shift: ln E that brings the fragment onto the curve, hat-weighted
};

/// About `points` places a channel, those that calibrating would choose for as many. `seconds` of the shots where they
/// are known better than their labels (empty: they are not). Channels whose codes no two shots share have none.
std::array<std::vector<CurveFragment>, 3> curve_fragments(const Bracket& bracket,
                                                          const std::vector<Mat3>& ref_from_photo,
                                                          const Response& response, const std::vector<double>& seconds,
                                                          int points);

}  // namespace hdr
