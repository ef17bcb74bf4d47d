#include "libhdr/probe/internal/place_outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

/// The ellipse that this circle's ball may have: it points at the picture's middle.
Ellipse pointing_at_middle(const Ellipse& outline, Size size) {
  const Vec2 out = outline.centre - Vec2(0.5 * size.width, 0.5 * size.height);
  Ellipse result = outline;
  if (out.norm() > 1e-6) result.along = out.normalized();
  return result;
}

constexpr int kCloseRadii = 720;

OutlineModel model(int radii, int half_window, double range, double step, std::size_t starts) {
  return OutlineModel(
      {.radii = radii, .half_window_px = half_window, .range_px = range, .step_px = step, .starts = starts});
}

bool less_evidence(const OutlineFit& a, const OutlineFit& b) {
  return a.evidence < b.evidence;
}

class Placing {
 public:
  Placing(const OutlinePicture& picture, const std::optional<double>& fov_degrees, const OutlineModel& start,
          const OutlineModel& wide, const OutlineModel& close)
      : picture_(picture),
        size_(picture.size()),
        fov_degrees_(fov_degrees),
        start_(start),
        wide_(wide),
        close_(close) {}

  /// The outline near a guess. A circle, unless an ellipse has clearly more evidence.
  OutlineFit operator()(const Ellipse& guess) const {
    if (fov_degrees_) return placed(start_with_known_field(guess), false);
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
  /// Within a few pixels, where long profiles see more, but also what lies deeper in the ball; from the guess itself;
  /// and from where few radii see most around it, since a coarser picture may have had another circle for the best one:
  /// whatever has most evidence close by. `elongates`: the ellipse's length is sought, too.
  OutlineFit placed(const Ellipse& guess, bool elongates) const {
    std::vector<Ellipse> starts = {wide_.fit(picture_, guess, elongates).outline, guess};
    if (!elongates) {
      for (const Ellipse& beside : best_beside(guess)) starts.push_back(beside);
    }
    std::vector<OutlineFit> fits(starts.size());
    for_rows(static_cast<int>(starts.size()), 1, [&](int first, int) {
      const auto k = static_cast<std::size_t>(first);
      fits[k] = settled(starts[k], elongates);
    });
    return *std::max_element(fits.begin(), fits.end(), less_evidence);
  }

  /// Of what few radii find from guesses up to kFar pixels off.
  std::vector<Ellipse> best_beside(const Ellipse& guess) const {
    constexpr double kFar = 4, kApart = 1;  // pixels
    constexpr std::size_t kMost = 2;
    std::vector<Ellipse> guesses;
    for (const double dr : {-kFar, 0.0, kFar}) {
      for (const Vec2& offset : {Vec2(0, 0), Vec2(kFar, 0), Vec2(-kFar, 0), Vec2(0, kFar), Vec2(0, -kFar)}) {
        if ((dr == 0 && offset.isZero()) || guess.minor + dr < 2 * kFar) continue;
        const Ellipse beside{guess.centre + offset, guess.along, guess.major + dr, guess.minor + dr};
        guesses.push_back(fov_degrees_ ? with_known_field(beside) : beside);
      }
    }
    std::vector<OutlineFit> fits(guesses.size());
    for_rows(static_cast<int>(guesses.size()), 1, [&](int first, int) {
      const auto k = static_cast<std::size_t>(first);
      fits[k] = start_.fit(picture_, guesses[k]);
    });
    std::stable_sort(fits.begin(), fits.end(), [](const auto& a, const auto& b) { return less_evidence(b, a); });
    std::vector<Ellipse> best;
    for (const OutlineFit& fit : fits) {
      const auto alike = [&](const Ellipse& e) {
        return (e.centre - fit.outline.centre).norm() + std::abs(e.minor - fit.outline.minor) < kApart;
      };
      if (best.size() < kMost && std::none_of(best.begin(), best.end(), alike)) best.push_back(fit.outline);
    }
    return best;
  }

  /// Close by, with short profiles, until they are read where the outline is.
  OutlineFit settled(Ellipse last, bool elongates) const {
    constexpr int kRounds = 4;
    constexpr double kSettled = 0.05;  // pixels
    OutlineFit fit;
    for (int round = 0; round < kRounds; ++round) {
      fit = close_.fit(picture_, fov_degrees_ ? with_known_field(last) : last, elongates, fit.clocks);
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
    const auto ball = ball_from_elongation(disc, middle, outline.major / outline.minor);
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
    return outline_of(ball_in_photograph(disc, size_, *fov_degrees_));
  }

  /// What a wide-angle lens makes of a ball there, pixels: half the square of the angle off its axis.
  double most_elongation(const Ellipse& guess) const {
    constexpr double kWidest = 110;  // degrees of horizontal field
    const double focal = 0.5 * size_.width / std::tan(0.5 * kWidest * kDegree);
    const Vec2 middle(0.5 * size_.width, 0.5 * size_.height);
    return 0.5 * guess.minor * (guess.centre - middle).squaredNorm() / (focal * focal);
  }

  const OutlinePicture& picture_;
  Size size_;
  std::optional<double> fov_degrees_;
  const OutlineModel &start_, &wide_, &close_;
};

}  // namespace

OutlinePlacer::OutlinePlacer(std::optional<double> fov_degrees)
    : fov_degrees_(fov_degrees),
      start_(model(96, 5, 3, 0.25, 3)),
      wide_(model(360, 7, 3, 0.125, 3)),
      close_(model(kCloseRadii, 5, 1.5, 0.125, 1)) {}

OutlineFit OutlinePlacer::operator()(const OutlinePicture& picture, const Ellipse& guess) const {
  return Placing(picture, fov_degrees_, start_, wide_, close_)(guess);
}

}  // namespace hdr::internal
