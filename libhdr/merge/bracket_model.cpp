#include "libhdr/merge/internal/bracket_model.h"

#include <fmt/format.h>

#include <algorithm>

#include "libhdr/response/estimate_noise.h"

namespace hdr::internal {

std::vector<ShotRole> roles_of(const Alignment& alignment) {
  // Averaged, a shot that lies elsewhere blurs or doubles what the others show. Without it a longer one leaves some
  // noise in the shadows; a shorter one may hold the only measure of a sun, which a few pixels off is better than none.
  constexpr double kWorstRegistration_px = 1;
  std::vector<ShotRole> roles(alignment.frames.size());
  for (std::size_t j = 0; j < roles.size(); ++j) {
    const double residual_px = alignment.frames[j].residual_px;
    if (static_cast<int>(j) == alignment.reference || residual_px <= kWorstRegistration_px) continue;
    roles[j].use = static_cast<int>(j) > alignment.reference ? ShotUse::kNowhere : ShotUse::kWhereOthersClip;
    roles[j].reason = fmt::format("registered within {:.1f} px only", residual_px);
  }
  return roles;
}

std::vector<bool> left_out(const std::vector<ShotRole>& roles) {
  std::vector<bool> out;
  for (const ShotRole& role : roles) out.push_back(role.use != ShotUse::kEverywhere);
  return out;
}

BracketModels models_of(const Bracket& bracket, const Alignment& alignment, const std::vector<ShotRole>& roles,
                        const Response& response, const MergeOptions& options) {
  const bool lossy = std::any_of(bracket.shots.begin(), bracket.shots.end(), [](const Photo& p) { return p.lossy; });
  MergeModelOptions model{lossy, options.weight, options.black_level, options.noise.value_or(Noise{}), {}};
  // The hat distrusts codes for more than their noise: an average camera is all it needs to know.
  const bool hat_alone = model.hat() && !options.uncertainty;
  model.noise = model.hat_noise;
  if (!options.noise.has_value() && !(hat_alone && !options.deghost)) {
    const auto ref_from_photo = alignment.identity() ? std::vector<Mat3>{} : alignment.ref_from_photo();
    const NoiseEstimate estimate = options.noise_estimate
                                       ? *options.noise_estimate
                                       : estimate_noise(bracket, ref_from_photo, response, left_out(roles));
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
