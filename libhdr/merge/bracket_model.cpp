#include "libhdr/merge/internal/bracket_model.h"

#include <fmt/format.h>

#include <algorithm>

#include "libhdr/response/estimate_noise.h"

namespace hdr::internal {

std::string reason_to_leave_out(const Alignment& alignment, std::size_t shot) {
  // Left out, a longer shot costs some noise in the shadows; a shorter one may hold the only measure of a sun.
  constexpr double kWorstRegistration_px = 1;
  const double residual_px = alignment.frames[shot].residual_px;
  if (static_cast<int>(shot) <= alignment.reference || residual_px <= kWorstRegistration_px) return "";
  return fmt::format("registered within {:.1f} px only", residual_px);
}

BracketModels models_of(const Bracket& bracket, const Alignment& alignment, const Response& response,
                        const MergeOptions& options) {
  const bool lossy = std::any_of(bracket.shots.begin(), bracket.shots.end(), [](const Photo& p) { return p.lossy; });
  MergeModelOptions model{lossy, options.weight, options.black_level, options.noise.value_or(Noise{}), {}};
  // The hat distrusts codes for more than their noise: an average camera is all it needs to know.
  const bool hat_alone = model.hat() && !options.uncertainty;
  model.noise = model.hat_noise;
  if (!options.noise.has_value() && !(hat_alone && !options.deghost)) {
    std::vector<bool> left_out;
    for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
      left_out.push_back(!reason_to_leave_out(alignment, j).empty());
    }
    const auto ref_from_photo = alignment.identity() ? std::vector<Mat3>{} : alignment.ref_from_photo();
    const NoiseEstimate estimate =
        options.noise_estimate ? *options.noise_estimate : estimate_noise(bracket, ref_from_photo, response, left_out);
    model.noise = estimate.noise;
    // Likelihood believes the noise model; where the shots differ by more than noise, the hat's doubt is the better
    // guide.
    constexpr double kMostOutliers = 0.01;
    if (model.kind == WeightKind::kAuto && estimate.outliers > kMostOutliers) model.kind = WeightKind::kHat;
  }
  BracketModels models{make_merge_model(response, model), {}};
  if (options.deghost) {
    model.kind = WeightKind::kVariance;
    models.likelihood = make_merge_model(response, model);
    models.likelihood->distrusts_ends = models.merge.hat;
  }
  return models;
}

}  // namespace hdr::internal
