#pragma once
// Finding the response from a bracket.
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/response.h"

namespace hdr {

struct CalibrateOptions {
  std::optional<double> smoothness;  ///< lambda of [Debevec97] eq. 3; absent: chosen from the data
  int pixels = 0;                    ///< points a channel; 0: as many as the fit needs
};

/// `rms_log_error` is the weighted rms of g(Z_ij) - ln E_i - ln H_j over the pixels used, in natural logs.
struct Calibration {
  Response response;
  double rms_log_error = 0;
  bool converged = false;
  double smoothness = 0;
  int pixels = 0;                     ///< points used, all channels together
  std::vector<std::string> warnings;  ///< e.g. codes that no pixel reached
};

/// [Debevec97] eq. 3: weights, smoothness, g(2^(bits-1)) = 0, solved in Ceres. `ref_from_photo[k]` maps pixels (centres
/// at integers) of shot k to the common grid; empty means registered. Throws Error when the bracket cannot determine a
/// response: one shot, equal exposures, no pixel that is neither black nor clipped in two shots.
Calibration calibrate_debevec_malik(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo = {},
                                    const CalibrateOptions& options = {});

/// A response good enough to linearise shots that are not registered yet: the same fit on the code quantiles of
/// the shots (histogram matching [Grossberg03] survives small shifts).
Response provisional_response(const Bracket& bracket);

}  // namespace hdr
