#include "libhdr/probe/find_ball.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/median.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/ball_camera.h"
#include "libhdr/probe/internal/circle_votes.h"
#include "libhdr/probe/internal/filling_circle.h"
#include "libhdr/probe/internal/luminance.h"
#include "libhdr/probe/internal/outline.h"
#include "libhdr/probe/internal/place_outline.h"
#include "libhdr/probe/internal/rim_stretch.h"

namespace hdr {
namespace {

constexpr int kCoarseSide = 512;       ///< candidates are sought in a picture no larger than this
constexpr int kLeastSide = 32;         ///< of a picture in which anything is sought
constexpr double kLeastRadius = 0.08;  ///< of the shorter side
constexpr double kMostRadius = 0.52;   ///< of the shorter side
constexpr int kCandidates = 60;
// Mean over the outline. Measured on 54 simulated balls in 8 scenes: all but one, in a nearly black studio, have more.
// Pictures without a ball stay below 0.3, but anything round has an edge: a lamp in a studio has 6.6.
constexpr double kLeastEvidence = 2;
constexpr double kLeastSupport = 0.5;
constexpr double kLeastInFrame = 0.6;
constexpr double kBlurred = 0.1;  ///< share of a coarser level's evidence below which a level is out of focus

/// One channel above a small share of its median, which keeps black and its noise from ruling.
Image<float> raised(Image<float> channel) {
  constexpr double kShareOfMedian = 0.05;
  std::vector<float> sample;
  for (int y = 0; y < channel.height(); y += 4) {
    for (int x = 0; x < channel.width(); x += 4) sample.push_back(channel(x, y));
  }
  const float base = std::max(1e-30f, static_cast<float>(kShareOfMedian) * median_of(sample));
  for (int y = 0; y < channel.height(); ++y) {
    for (int x = 0; x < channel.width(); ++x) channel(x, y) += base;
  }
  return channel;
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
  return second.empty() ? kLeast : std::max(kLeast, 1.4826 * static_cast<double>(median_of(second)) / std::sqrt(6.0));
}

/// The picture in halves of halves, the finest first.
struct Levels {
  explicit Levels(View<const float> rgb)
      : luminance(internal::halvings(raised(internal::luminance_of(rgb)), kCoarseSide, kLeastSide)),
        red(internal::halvings(raised(internal::channel_of(rgb, 0)), kCoarseSide, kLeastSide)),
        blue(internal::halvings(raised(internal::channel_of(rgb, 2)), kCoarseSide, kLeastSide)) {}

  std::size_t size() const { return luminance.size(); }
  internal::OutlinePicture at(std::size_t level, bool plain) const {
    return {luminance[level], red[level], blue[level], noise_of(luminance[level]), plain};
  }

  std::vector<Image<float>> luminance, red, blue;
};

Image<float> logarithm(const Image<float>& picture) {
  Image<float> result(picture.size(), 1);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) result(x, y) = std::log(picture(x, y));
  }
  return result;
}

using internal::Ellipse;
using internal::OutlineFit;

Ellipse scaled(const Ellipse& outline, double scale) {
  return {scale * outline.centre, outline.along, scale * outline.major, scale * outline.minor};
}

/// Whether an outline holds a sphere's reflection, judged in a picture in which its texture is well resolved, or else
/// in the next finer one: what is fine (stars, leaves) is blurred away in the first, what is coarse is noisy in the
/// second.
bool holds_reflection(const std::vector<Image<float>>& levels, const Ellipse& outline) {
  constexpr double kResolvedRadius = 220;
  std::size_t level = 0;
  while (level + 1 < levels.size() && std::ldexp(outline.minor, -static_cast<int>(level)) > kResolvedRadius) ++level;
  const auto mirrored_in = [&](std::size_t k) {
    const Ellipse there = scaled(outline, std::ldexp(1.0, -static_cast<int>(k)));
    return internal::is_mirrored(internal::rim_stretch(levels[k], there, noise_of(levels[k])));
  };
  return mirrored_in(level) || (level > 0 && mirrored_in(level - 1));
}

/// A circle beside a lamp's, which crosses its edge and so has slopes all over, is no better than the lamp's own.
bool nearly_alike(const Ellipse& a, const Ellipse& b) {
  constexpr double kNear = 0.15;  // of the radius
  return (a.centre - b.centre).norm() + std::abs(a.minor - b.minor) < kNear * b.minor;
}

/// The circle with the most evidence that holds a reflection, in the coarsest picture.
OutlineFit best_circle(const Levels& levels) {
  const Image<float>& luminance = levels.luminance.back();
  const internal::OutlinePicture picture = levels.at(levels.size() - 1, false);
  const double scale = std::exp2(static_cast<double>(levels.size()) - 1);
  const double side = std::min(luminance.width(), luminance.height());
  const auto circles = internal::vote_for_circles(logarithm(luminance), std::max(8.0, kLeastRadius * side),
                                                  kMostRadius * side, kCandidates);
  const internal::OutlineModel model({.radii = 96, .half_window_px = 5, .range_px = 4, .step_px = 0.5});
  std::vector<OutlineFit> fits(circles.size());
  for_rows(static_cast<int>(circles.size()), 1, [&](int k, int) {
    const Disc& disc = circles[static_cast<std::size_t>(k)];
    fits[static_cast<std::size_t>(k)] = model.fit(picture, internal::circle_of(disc));
  });
  std::stable_sort(fits.begin(), fits.end(), [](const auto& a, const auto& b) { return a.evidence > b.evidence; });
  std::vector<Ellipse> refused;
  for (const OutlineFit& fit : fits) {
    if (fit.evidence < kLeastEvidence) break;
    if (fit.in_frame < kLeastInFrame || fit.support < kLeastSupport) continue;
    const auto alike = [&](const Ellipse& other) { return nearly_alike(fit.outline, other); };
    if (std::any_of(refused.begin(), refused.end(), alike)) continue;
    if (holds_reflection(levels.luminance, scaled(fit.outline, scale))) return fit;
    refused.push_back(fit.outline);
  }
  return {};
}

MirrorBall ball_of(const Ellipse& outline, Size size, const FindBallOptions& options) {
  const MirrorBall far{{outline.centre.x(), outline.centre.y(), outline.minor}};
  if (options.fov_degrees) return ball_in_photograph(far.disc, size, *options.fov_degrees);
  if (outline.major <= outline.minor) return far;
  const Vec2 middle(0.5 * size.width, 0.5 * size.height);
  return internal::ball_from_elongation(far.disc, middle, outline.major / outline.minor).value_or(far);
}

/// Without the rim's own evidence: a circle that nearly fills the frame, judged where blur is some pixels.
std::optional<FoundBall> filling_ball(Image<float> luminance, const FindBallOptions& options) {
  constexpr int kSide = 160;
  const auto circle = internal::find_filling_circle(luminance);
  if (!circle) return std::nullopt;
  const Ellipse outline = internal::circle_of(circle->disc);
  const Size size = luminance.size();
  const std::vector<Image<float>> levels = internal::halvings(std::move(luminance), kSide, kLeastSide);
  const double scale = std::exp2(1 - static_cast<double>(levels.size()));
  if (!internal::is_mirrored(internal::rim_stretch(levels.back(), scaled(outline, scale), noise_of(levels.back())))) {
    return std::nullopt;
  }
  const MirrorBall ball = ball_of(outline, size, options);
  return FoundBall{ball, circle->support, circle->residual_px};
}

}  // namespace

std::optional<FoundBall> find_ball(View<const float> rgb, const FindBallOptions& options) {
  if (rgb.channels() < 3 || std::min(rgb.width(), rgb.height()) < kLeastSide) return std::nullopt;
  Levels levels(rgb);

  // In the coarsest picture: the circle with the most evidence of all that the edges vote for.
  const OutlineFit coarse = best_circle(levels);
  if (coarse.evidence < kLeastEvidence) return filling_ball(std::move(levels.luminance.front()), options);

  const internal::OutlinePlacer place(options.fov_degrees);
  // From level to level the outline is placed more finely, as long as it is sharp enough to show there.
  double scale = std::exp2(static_cast<double>(levels.size()) - 1);
  Ellipse outline = scaled(coarse.outline, scale);
  FoundBall best{{}, coarse.support, scale * coarse.residual_px};
  double most = 0;  // evidence of a level so far; the coarsest may have held another circle for the best one
  for (std::size_t level = levels.size(); level-- > 0; scale *= 0.5) {
    const OutlineFit fit = place(levels.at(level, level == 0), scaled(outline, 1 / scale));
    const bool lost = !(fit.outline.minor > 1) || !std::isfinite(fit.outline.major);  // a fit to noise may run away
    if (lost || (level + 1 < levels.size() && fit.evidence < kBlurred * most)) break;
    most = std::max(most, fit.evidence);
    outline = scaled(fit.outline, scale);
    best.support = fit.support;
    best.residual_px = scale * fit.residual_px;
  }
  if (!holds_reflection(levels.luminance, outline)) return std::nullopt;
  best.ball = ball_of(outline, rgb.size(), options);
  return best;
}

}  // namespace hdr
