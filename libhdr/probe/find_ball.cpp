#include "libhdr/probe/find_ball.h"

#include <algorithm>
#include <array>
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
constexpr double kBlurred = 0.1;  ///< share of the coarse picture's evidence below which a level is out of focus

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

/// The picture in halves of halves, the finest first.
struct Levels {
  explicit Levels(View<const float> rgb)
      : luminance(internal::halvings(raised(internal::luminance_of(rgb)), kCoarseSide, kLeastSide)),
        red(internal::halvings(raised(internal::channel_of(rgb, 0)), kCoarseSide, kLeastSide)),
        blue(internal::halvings(raised(internal::channel_of(rgb, 2)), kCoarseSide, kLeastSide)) {}

  std::size_t size() const { return luminance.size(); }
  internal::OutlinePicture at(std::size_t level) const { return {luminance[level], red[level], blue[level]}; }

  std::vector<Image<float>> luminance, red, blue;
};

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
  return second.empty() ? kLeast : std::max(kLeast, 1.4826 * static_cast<double>(median_of(second)) / std::sqrt(6.0));
}

using internal::Ellipse;
using internal::OutlineFit;

Ellipse scaled(const Ellipse& outline, double scale) {
  return {scale * outline.centre, outline.along, scale * outline.major, scale * outline.minor};
}

/// The ellipse that this circle's ball may have: it points at the picture's middle.
Ellipse pointing_at_middle(const Ellipse& outline, Size size) {
  const Vec2 out = outline.centre - Vec2(0.5 * size.width, 0.5 * size.height);
  Ellipse result = outline;
  if (out.norm() > 1e-6) result.along = out.normalized();
  return result;
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
    const Disc disc{there.centre.x(), there.centre.y(), there.minor};
    return internal::is_mirrored(internal::rim_stretch(levels[k], disc, noise_of(levels[k])));
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
  const internal::OutlinePicture picture = levels.at(levels.size() - 1);
  const double scale = std::exp2(static_cast<double>(levels.size()) - 1);
  const double side = std::min(luminance.width(), luminance.height());
  const auto circles = internal::vote_for_circles(logarithm(luminance), std::max(8.0, kLeastRadius * side),
                                                  kMostRadius * side, kCandidates);
  const internal::OutlineModel model(
      {.radii = 96, .half_window_px = 5, .range_px = 4, .step_px = 0.5, .noise = noise_of(luminance)});
  std::vector<OutlineFit> fits(circles.size());
  for_rows(static_cast<int>(circles.size()), 1, [&](int k, int) {
    const Disc& disc = circles[static_cast<std::size_t>(k)];
    fits[static_cast<std::size_t>(k)] = model.fit(picture, {{disc.cx, disc.cy}, {1, 0}, disc.r, disc.r});
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

/// Places an outline in one level of the pyramid.
class Placing {
 public:
  Placing(const Levels& levels, std::size_t level, const FindBallOptions& options)
      : Placing(levels.at(level), options, noise_of(levels.luminance[level])) {}

  /// The outline near a guess. A circle, unless an ellipse has clearly more evidence.
  OutlineFit operator()(const Ellipse& guess) const {
    if (options_.fov_degrees) return placed(start_with_known_field(guess), false);
    const double radius = 0.5 * (guess.major + guess.minor);
    const OutlineFit round = placed({guess.centre, guess.along, radius, radius}, false);
    if (most_elongation(guess) < kLeastElongation) return round;
    const OutlineFit longer = placed(elongated(pointing_at_middle(guess, size_)), true);
    const double elongation = longer.outline.major - longer.outline.minor;
    const bool possible = elongation > 0 && elongation <= most_elongation(guess) && far_enough(longer.outline);
    const bool plain =
        gains_all_around(longer, round) || (elongation >= kPlainElongation && scatters_less(longer, round, elongation));
    return possible && plain ? longer : round;
  }

 private:
  Placing(const internal::OutlinePicture& picture, const FindBallOptions& options, double noise)
      : picture_(picture),
        size_{picture.luminance.width(), picture.luminance.height()},
        options_(options),
        start_({.radii = 96, .half_window_px = 5, .range_px = 3, .step_px = 0.25, .noise = noise, .starts = 3}),
        wide_({.radii = 360, .half_window_px = 7, .range_px = 3, .step_px = 0.125, .noise = noise, .starts = 3}),
        close_({.radii = kCloseRadii, .half_window_px = 5, .range_px = 1.5, .step_px = 0.125, .noise = noise}) {}

  /// First within a few pixels, where long profiles see more, but also what lies deeper in the ball; or from the guess
  /// itself: the one that has more evidence close by. `elongates`: the ellipse's length is sought, too.
  OutlineFit placed(const Ellipse& guess, bool elongates) const {
    OutlineFit from_afar = settled(wide_.fit(picture_, guess, elongates).outline, elongates);
    OutlineFit from_guess = settled(guess, elongates);
    return from_guess.evidence > from_afar.evidence ? from_guess : from_afar;
  }

  /// Close by, with short profiles, until they are read where the outline is.
  OutlineFit settled(Ellipse last, bool elongates) const {
    constexpr int kRounds = 4;
    constexpr double kSettled = 0.05;  // pixels
    OutlineFit fit;
    for (int round = 0; round < kRounds; ++round) {
      fit = close_.fit(picture_, options_.fov_degrees ? with_known_field(last) : last, elongates, fit.clocks);
      const Ellipse& here = fit.outline;
      if ((here.centre - last.centre).norm() + std::abs(here.minor - last.minor) < kSettled) break;
      last = here;
    }
    return fit;
  }

  /// A start that is as long as the ellipse with the most evidence, where circles are too far from it to get there.
  Ellipse elongated(const Ellipse& guess) const {
    constexpr double kStep = 4;            // pixels: less than the search reaches both ways
    constexpr double kMostOfRadius = 0.1;  // 25 degrees off the axis
    const double r = guess.minor, longest = std::min(most_elongation(guess), kMostOfRadius * r);
    if (guess.major > guess.minor || longest < kStep) return guess;
    Ellipse best = guess;
    double most = start_.fit(picture_, guess, true).evidence;
    for (double e = kStep; e <= longest; e += kStep) {
      for (const double shorter : {0.0, 0.5, 1.0}) {  // a circle lies at either end of an ellipse, or between
        const Ellipse start{guess.centre, guess.along, r + (1 - shorter) * e, r - shorter * e};
        const double evidence = start_.fit(picture_, start, true).evidence;
        if (evidence > most) most = evidence, best = start;
      }
    }
    return best;
  }

  static constexpr double kLeastElongation = 0.3;  ///< pixels by which an ellipse differs from a circle
  static constexpr int kCloseRadii = 720;
  // In ln likelihood over all radii, of which some thirty are independent. Of 52 balls four true ellipses had .54
  // to 1.1 a radius, of which .25 and more was left without their best quarter; false ones up to 1.3, but at most .16
  // without.
  static constexpr double kLeastGain = 0.42 * kCloseRadii, kLeastGainElsewhere = 0.21 * kCloseRadii;
  static constexpr double kPlainElongation = 0.75;  ///< pixels; of 150 balls few far ones seemed to have more
  static constexpr double kNearest = 3;             ///< radii: nearer than that nobody photographs a ball

  /// An arc along which something straight passes behind the ball may be gone around by an ellipse, too: that is a gain
  /// in one quarter of the outline.
  static bool gains_all_around(const OutlineFit& longer, const OutlineFit& round) {
    constexpr std::size_t kOctants = 8;
    std::array<double, kOctants> gains;
    double total = 0, best_quarter = 0;
    for (std::size_t k = 0; k < kOctants; ++k) total += gains[k] = longer.octants[k] - round.octants[k];
    for (std::size_t k = 0; k < kOctants; ++k) {
      best_quarter = std::max(best_quarter, gains[k] + gains[(k + 1) % kOctants]);
    }
    return total > kLeastGain && total - best_quarter > kLeastGainElsewhere;
  }

  /// Around a circle the radii of an ellipse have their own best places at e/2 cos 2t, which is gone around the
  /// ellipse: evidence, bounded a radius, may not see what so many agree on.
  static bool scatters_less(const OutlineFit& longer, const OutlineFit& round, double elongation) {
    // They look no farther than 1.5 pixels: around a circle far off they scatter no more than that lets them.
    constexpr double kMostOfIt = 1.15;
    const double had = round.residual_px * round.residual_px;
    const double expected = std::min(elongation * elongation / 8, kMostOfIt * had);
    return had - longer.residual_px * longer.residual_px >= 0.5 * expected;
  }

  /// Half a pixel of elongation near the middle may be an error, and would put the camera beside the ball.
  bool far_enough(const Ellipse& outline) const {
    const Vec2 middle(0.5 * size_.width, 0.5 * size_.height);
    const Disc disc{outline.centre.x(), outline.centre.y(), outline.minor};
    const auto ball = internal::ball_from_elongation(disc, middle, outline.major / outline.minor);
    return ball && ball->distance >= kNearest;
  }

  /// The circle that was seen may lie at either end of the ellipse, or between.
  Ellipse start_with_known_field(const Ellipse& guess) const {
    constexpr double kNoticed = 2;  // pixels
    Ellipse best = with_known_field(guess);
    const double elongation = best.major - best.minor;
    if (guess.major > guess.minor || elongation < kNoticed) return best;
    double most = start_.fit(picture_, best).evidence;
    for (const double shorter : {0.5, 1.0}) {
      Ellipse start = guess;
      start.minor -= shorter * elongation;
      start = with_known_field(start);
      const double evidence = start_.fit(picture_, start).evidence;
      if (evidence > most) most = evidence, best = start;
    }
    return best;
  }

  Ellipse with_known_field(const Ellipse& guess) const {
    const Disc disc{guess.centre.x(), guess.centre.y(), guess.minor};
    return internal::outline_of(ball_in_photograph(disc, size_, *options_.fov_degrees));
  }

  /// What a wide-angle lens makes of a ball there, pixels: half the square of the angle off its axis.
  double most_elongation(const Ellipse& guess) const {
    constexpr double kWidest = 110;  // degrees of horizontal field
    const double focal = 0.5 * size_.width / std::tan(0.5 * kWidest * kDegree);
    const Vec2 middle(0.5 * size_.width, 0.5 * size_.height);
    return 0.5 * guess.minor * (guess.centre - middle).squaredNorm() / (focal * focal);
  }

  internal::OutlinePicture picture_;
  Size size_;
  const FindBallOptions& options_;
  internal::OutlineModel start_, wide_, close_;
};

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
  const Disc& d = circle->disc;
  const Size size = luminance.size();
  const std::vector<Image<float>> levels = internal::halvings(std::move(luminance), kSide, kLeastSide);
  const double scale = std::exp2(1 - static_cast<double>(levels.size()));
  if (!internal::is_mirrored(
          internal::rim_stretch(levels.back(), {scale * d.cx, scale * d.cy, scale * d.r}, noise_of(levels.back())))) {
    return std::nullopt;
  }
  const MirrorBall ball = ball_of({{d.cx, d.cy}, {1, 0}, d.r, d.r}, size, options);
  return FoundBall{ball, circle->support, circle->residual_px};
}

}  // namespace

std::optional<FoundBall> find_ball(View<const float> rgb, const FindBallOptions& options) {
  if (rgb.channels() < 3 || std::min(rgb.width(), rgb.height()) < kLeastSide) return std::nullopt;
  Levels levels(rgb);

  // In the coarsest picture: the circle with the most evidence of all that the edges vote for.
  const OutlineFit coarse = best_circle(levels);
  if (coarse.evidence < kLeastEvidence) return filling_ball(std::move(levels.luminance.front()), options);

  // From level to level the outline is placed more finely, as long as it is sharp enough to show there.
  double scale = std::exp2(static_cast<double>(levels.size()) - 1);
  Ellipse outline = scaled(coarse.outline, scale);
  FoundBall best{{}, coarse.support, scale * coarse.residual_px};
  for (std::size_t level = levels.size(); level-- > 0; scale *= 0.5) {
    const OutlineFit fit = Placing(levels, level, options)(scaled(outline, 1 / scale));
    const bool lost = !(fit.outline.minor > 1) || !std::isfinite(fit.outline.major);  // a fit to noise may run away
    if (lost || fit.evidence < kBlurred * coarse.evidence) break;
    outline = scaled(fit.outline, scale);
    best.support = fit.support;
    best.residual_px = scale * fit.residual_px;
  }
  if (!holds_reflection(levels.luminance, outline)) return std::nullopt;
  best.ball = ball_of(outline, rgb.size(), options);
  return best;
}

}  // namespace hdr
