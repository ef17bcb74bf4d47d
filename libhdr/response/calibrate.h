#pragma once
// Finding the response from a bracket.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/estimate_noise.h"
#include "libhdr/response/response.h"

namespace hdr {

struct CalibrateOptions {
  std::optional<double> smoothness;  ///< lambda of [Debevec97] eq. 3; absent: chosen from the data
  int pixels = 0;                    ///< points a channel; 0: as many as the fit needs
  /// Exposure times are unknowns too (slope and mean of their logs fixed, each within a quarter of a stop). Labels of a
  /// camera's 1/3-stop scale (1/60) are first taken as the powers of two they stand for, where that fits better.
  bool refine_times = false;
};

/// `rms_log_error` is the weighted rms of g(Z_ij) - ln E_i - ln H_j over the pixels used, in natural logs.
struct Calibration {
  Response response;
  double rms_log_error = 0;
  bool converged = false;
  double smoothness = 0;
  int pixels = 0;  ///< points used, all channels together
  /// Standard deviation of g at each of its samples, natural log: the fit's own doubt, relative to the middle code.
  std::array<std::vector<double>, 3> deviation;
  /// Seconds of each shot as refined, in the order of Bracket::shots; as given when that was not asked for.
  std::vector<double> seconds;
  /// Of the shots, where the fit needed it (lossless ones): merging need not measure it again.
  std::optional<NoiseEstimate> noise;
  std::vector<std::string> warnings;  ///< e.g. codes that no pixel reached
};

/// [Debevec97] eq. 3 in Ceres, g(2^(bits-1)) = 0: first with the hat's weights, then with those of the noise that this
/// curve shows in the shots. `ref_from_photo[k]` maps pixels (centres
/// at integers) of shot k to the common grid; empty means registered. Throws Error when the bracket cannot determine a
/// response: one shot, equal exposures, no pixel that is neither black nor clipped in two shots.
Calibration calibrate_debevec_malik(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo = {},
                                    const CalibrateOptions& options = {});

/// [Robertson03]: alternates between the irradiance of each pixel and the exposure of each code, Gauss-Seidel on
/// sum w(y_ij) (I_{y_ij} - t_j x_i)^2, with no assumption on the curve. Of `options` only `pixels` counts. Arguments
/// and errors as above.
Calibration calibrate_robertson(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo = {},
                                const CalibrateOptions& options = {});

/// [Mitsunaga99]: f^-1 is a polynomial of the code, of the order (up to 10) that predicts held-out points best, fitted
/// to pairs of neighbouring shots; with `options.refine_times` in alternation with the ratios of their exposures. The
/// channels are not scaled to each other: each is 0 at the middle code, as every Response. Arguments and errors as
/// above.
Calibration calibrate_mitsunaga_nayar(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo = {},
                                      const CalibrateOptions& options = {});

enum class CalibrateMethod { kDebevecMalik, kRobertson, kMitsunagaNayar };

/// "debevec-malik", "robertson", "mitsunaga-nayar"; nullopt for any other text.
std::optional<CalibrateMethod> calibrate_method_from_name(const std::string& name);

/// One of the three.
Calibration calibrate(CalibrateMethod method, const Bracket& bracket, const std::vector<Mat3>& ref_from_photo = {},
                      const CalibrateOptions& options = {});

/// A response good enough to linearise shots that are not registered yet: the same fit on the code quantiles of
/// the shots (histogram matching [Grossberg03] survives small shifts).
Response provisional_response(const Bracket& bracket);

}  // namespace hdr
