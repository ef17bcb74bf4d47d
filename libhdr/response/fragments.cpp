#include "libhdr/response/fragments.h"

#include <cmath>

#include "libhdr/response/internal/code_weights.h"
#include "libhdr/response/internal/observations.h"

namespace hdr {
namespace {

/// The mean over the shots of g(Z_ij) - ln H_j, by the hat: [Debevec97] eq. 6.
double shift_of(const CurveFragment& fragment, const Response& response, int channel) {
  double sum = 0, weights = 0;
  const double max_code = std::ldexp(1.0, response.bits) - 1;
  for (std::size_t k = 0; k < fragment.codes.size(); ++k) {
    const double weight = hat_weight(fragment.codes[k], max_code);
    sum += weight * (response.ln_exposure(channel, fragment.codes[k]) - fragment.ln_exposure[k]);
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

std::array<std::vector<CurveFragment>, 3> curve_fragments(const Bracket& bracket,
                                                          const std::vector<Mat3>& ref_from_photo,
                                                          const Response& response, const std::vector<double>& seconds,
                                                          int points) {
  HDR_ASSERT(seconds.empty() || seconds.size() == bracket.shots.size());
  const Observations seen = sample_points(bracket, ref_from_photo, points);
  std::array<std::vector<CurveFragment>, 3> fragments;
  for (int c = 0; c < 3; ++c) {
    const Eigen::MatrixXd& codes = seen.codes[static_cast<std::size_t>(c)];
    for (Eigen::Index i = 0; i < codes.rows(); ++i) {
      CurveFragment fragment;
      for (Eigen::Index j = 0; j < codes.cols(); ++j) {
        if (std::isnan(codes(i, j))) continue;
        const auto shot = static_cast<std::size_t>(j);
        const double refined = seconds.empty() ? 1 : seconds[shot] / *bracket.shots[shot].exposure.seconds;
        fragment.codes.push_back(codes(i, j));
        fragment.ln_exposure.push_back(seen.ln_exposure[j] + std::log(refined));
      }
      if (fragment.codes.size() < 2) continue;  // a place alone says nothing
      fragment.ln_radiance = shift_of(fragment, response, c);
      fragments[static_cast<std::size_t>(c)].push_back(std::move(fragment));
    }
  }
  return fragments;
}

}  // namespace hdr
