#include "libhdr/probe/find_ball.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/probe/internal/circle_votes.h"
#include "libhdr/probe/internal/luminance.h"
#include "libhdr/probe/internal/outline.h"

namespace hdr {
namespace {

constexpr int kCoarseSide = 512;       ///< candidates are sought in a picture no larger than this
constexpr double kLeastRadius = 0.08;  ///< of the shorter side
constexpr double kMostRadius = 0.52;   ///< of the shorter side
constexpr int kCandidates = 60;
// Mean over the outline. Measured on 54 simulated balls in 8 scenes: all but one, in a nearly black studio, have more.
// Pictures without a ball stay below 0.3, but a round lamp in a studio has 6.6.
constexpr double kLeastEvidence = 2;
constexpr double kLeastSupport = 0.5;
constexpr double kLeastInFrame = 0.6;
constexpr double kBlurred = 0.1;  ///< share of the coarse picture's evidence below which a level is out of focus

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Luminance above a small share of its median, which keeps black and its noise from ruling.
Image<float> raised_luminance(View<const float> rgb) {
  constexpr double kShareOfMedian = 0.05;
  Image<float> result = internal::luminance_of(rgb);
  std::vector<float> sample;
  for (int y = 0; y < rgb.height(); y += 4) {
    for (int x = 0; x < rgb.width(); x += 4) sample.push_back(result(x, y));
  }
  const float base = std::max(1e-30f, static_cast<float>(kShareOfMedian) * median(sample));
  for (int y = 0; y < rgb.height(); ++y) {
    for (int x = 0; x < rgb.width(); ++x) result(x, y) += base;
  }
  return result;
}

Image<float> logarithm(const Image<float>& picture) {
  Image<float> result(picture.size(), 1);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) result(x, y) = std::log(picture(x, y));
  }
  return result;
}

/// Standard deviation of a pixel's noise as a share of its value: from the median of |I(x-1) - 2 I(x) + I(x+1)|, which
/// edges hardly move.
double noise_of(const Image<float>& picture) {
  constexpr double kLeast = 1e-3;
  std::vector<float> second;
  for (int y = 0; y < picture.height(); y += 2) {
    for (int x = 1; x + 1 < picture.width(); x += 2) {
      second.push_back(std::abs(picture(x - 1, y) + picture(x + 1, y) - 2 * picture(x, y)) / picture(x, y));
    }
  }
  return second.empty() ? kLeast : std::max(kLeast, 1.4826 * static_cast<double>(median(second)) / std::sqrt(6.0));
}

Disc scaled(const Disc& disc, double scale) {
  return {scale * disc.cx, scale * disc.cy, scale * disc.r};
}

internal::OutlineFit best_circle(const Image<float>& luminance) {
  const double side = std::min(luminance.width(), luminance.height());
  const auto circles = internal::vote_for_circles(logarithm(luminance), std::max(8.0, kLeastRadius * side),
                                                  kMostRadius * side, kCandidates);
  const internal::OutlineModel model(
      {.radii = 96, .half_window_px = 5, .range_px = 4, .step_px = 0.5, .noise = noise_of(luminance)});
  std::vector<internal::OutlineFit> fits(circles.size());
  for_rows(static_cast<int>(circles.size()), 1, [&](int k, int) {
    fits[static_cast<std::size_t>(k)] = model.fit(luminance, circles[static_cast<std::size_t>(k)]);
  });
  internal::OutlineFit best;
  for (const internal::OutlineFit& fit : fits) {
    if (fit.in_frame >= kLeastInFrame && fit.evidence > best.evidence) best = fit;
  }
  return best;
}

/// The circle near a guess: first within a few pixels, then close by with short profiles, in which what lies deeper in
/// the ball has no say.
internal::OutlineFit placed(const Image<float>& luminance, const Disc& guess) {
  const double noise = noise_of(luminance);
  const internal::OutlineModel wide(
      {.radii = 360, .half_window_px = 7, .range_px = 3, .step_px = 0.125, .noise = noise});
  const internal::OutlineModel narrow(
      {.radii = 360, .half_window_px = 5, .range_px = 1.5, .step_px = 0.125, .noise = noise});
  return narrow.fit(luminance, wide.fit(luminance, guess).disc);
}

}  // namespace

std::optional<FoundBall> find_ball(View<const float> rgb) {
  constexpr int kLeastSide = 32;
  if (rgb.channels() < 3 || std::min(rgb.width(), rgb.height()) < kLeastSide) return std::nullopt;
  const std::vector<Image<float>> levels = internal::halvings(raised_luminance(rgb), kCoarseSide, kLeastSide);

  // In the coarsest picture: the circle with the most evidence of all that the edges vote for.
  const internal::OutlineFit coarse = best_circle(levels.back());
  if (coarse.evidence < kLeastEvidence || coarse.support < kLeastSupport) return std::nullopt;

  // From level to level the circle is placed more finely, as long as the outline is sharp enough to show there.
  double scale = std::exp2(static_cast<double>(levels.size()) - 1);
  FoundBall best{scaled(coarse.disc, scale), coarse.support, scale * coarse.residual_px};
  for (auto level = levels.rbegin(); level < levels.rend(); ++level, scale *= 0.5) {
    const internal::OutlineFit fit = placed(*level, scaled(best.disc, 1 / scale));
    if (fit.evidence < kBlurred * coarse.evidence) break;
    best = {scaled(fit.disc, scale), fit.support, scale * fit.residual_px};
  }
  return best;
}

}  // namespace hdr
