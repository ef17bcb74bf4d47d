#include "libhdr/align/align.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "libhdr/align/internal/pairs.h"
#include "libhdr/align/internal/report.h"
#include "libhdr/core/parallel.h"

namespace hdr {
namespace {

constexpr double kFewestUsable = 0.02;  // share of the pixels below which a shot says nothing about its place

std::vector<internal::SharedSamples> sampled(const Bracket& bracket) {
  std::vector<internal::SharedSamples> samples(bracket.shots.size());
  for_rows(static_cast<int>(samples.size()), 1, [&](int first, int) {
    const auto k = static_cast<std::size_t>(first);
    samples[k] = samples_of(bracket.shots[k]);
  });
  return samples;
}

std::vector<double> usable_shares(const Bracket& bracket, std::span<const internal::SharedSamples> samples) {
  std::vector<double> shares;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    shares.push_back(internal::usable_share(*samples[k], bracket.shots[k].max_code()));
  }
  return shares;
}

/// The shot with the largest share of usable pixels; of those within 1 % of it, the one nearest to the middle.
int best_exposed(const std::vector<double>& shares) {
  if (shares.empty()) return 0;
  const double largest = *std::max_element(shares.begin(), shares.end());
  // A shot that can be registered is better than one that cannot.
  const double least = largest < kFewestUsable ? largest - 0.01 : std::max(kFewestUsable, largest - 0.01);
  const double middle = 0.5 * (static_cast<double>(shares.size()) - 1);
  int best = -1;
  for (int k = 0; k < static_cast<int>(shares.size()); ++k) {
    if (shares[static_cast<std::size_t>(k)] < least) continue;
    if (best < 0 || std::abs(k - middle) < std::abs(best - middle)) best = k;
  }
  return best;
}

}  // namespace

std::optional<AlignMethod> align_method_from_name(const std::string& name) {
  if (name == "auto") return AlignMethod::kAuto;
  if (name == "none") return AlignMethod::kNone;
  if (name == "mtb") return AlignMethod::kMtb;
  if (name == "ecc") return AlignMethod::kEcc;
  if (name == "features") return AlignMethod::kFeatures;
  return std::nullopt;
}

bool Alignment::identity() const {
  return std::all_of(frames.begin(), frames.end(),
                     [](const FrameAlignment& f) { return f.ref_from_photo == Mat3::Identity(); });
}

std::vector<Mat3> Alignment::ref_from_photo() const {
  std::vector<Mat3> transforms;
  for (const FrameAlignment& frame : frames) transforms.push_back(frame.ref_from_photo);
  return transforms;
}

Alignment no_alignment(const Bracket& bracket) {
  Alignment alignment;
  alignment.reference = best_exposed(usable_shares(bracket, sampled(bracket)));
  alignment.frames.resize(bracket.shots.size());
  for (FrameAlignment& frame : alignment.frames) frame.skipped = "not asked for";
  return alignment;
}

namespace {

std::vector<internal::Place> places_of(const Bracket& bracket, std::span<const internal::SharedSamples> samples,
                                       const std::vector<int>& used, int reference,
                                       const internal::Linearizer& linearizer, AlignMethod method) {
  const internal::MotionFrame frame(bracket.size());
  const auto shots = static_cast<int>(used.size());
  if (method == AlignMethod::kAuto) {
    if (const auto pairs = internal::still_pairs(bracket, samples, used, linearizer)) {
      const std::vector<internal::Place> places = internal::reconcile(frame, shots, reference, *pairs);
      if (internal::bracket_stays(frame, places)) return places;
    }
  }
  return internal::reconcile(frame, shots, reference, internal::measure_pairs(bracket, used, linearizer, method));
}

}  // namespace

Alignment align(const Bracket& bracket, const Response& response, AlignMethod method) {
  if (method == AlignMethod::kNone) return no_alignment(bracket);
  const std::vector<internal::SharedSamples> samples = sampled(bracket);
  const std::vector<double> shares = usable_shares(bracket, samples);
  Alignment alignment;
  alignment.reference = best_exposed(shares);
  alignment.frames.resize(bracket.shots.size());
  std::vector<int> used;
  for (int k = 0; k < static_cast<int>(shares.size()); ++k) {
    if (shares[static_cast<std::size_t>(k)] >= kFewestUsable) used.push_back(k);
  }
  if (!used.empty()) {
    const bool lossy = std::any_of(bracket.shots.begin(), bracket.shots.end(), [](const Photo& p) { return p.lossy; });
    const internal::Linearizer linearizer(response, bracket.bits(), lossy);
    const internal::MotionFrame frame(bracket.size());
    const auto reference =
        static_cast<int>(std::lower_bound(used.begin(), used.end(), alignment.reference) - used.begin());
    HDR_ASSERT(used[static_cast<std::size_t>(reference)] == alignment.reference);
    const std::vector<internal::Place> places = places_of(bracket, samples, used, reference, linearizer, method);
    const bool still = internal::bracket_stays(frame, places);
    for (std::size_t k = 0; k < used.size(); ++k) {
      alignment.frames[static_cast<std::size_t>(used[k])] = internal::decided(frame, places[k], still);
    }
    // The reference is the grid itself. It is reported as skipped only when everything is.
    FrameAlignment& grid = alignment.frames[static_cast<std::size_t>(alignment.reference)];
    grid = {};
    grid.inliers = 1;
    if (still) grid.skipped = "the reference: every shot lies on it";
  }
  internal::place_unusable(bracket, used, alignment.frames);
  return alignment;
}

}  // namespace hdr
