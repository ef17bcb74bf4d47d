#include "libhdr/probe/internal/rotation_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr::internal {
namespace {

/// `count` rotations spread evenly over SO(3): super-Fibonacci spirals [Alexa22].
Mat3 spread_rotation(int k, int count) {
  constexpr double kPhi = std::numbers::sqrt2, kPsi = 1.533751168755204288118041;
  const double s = k + 0.5, t = s / count, r = std::sqrt(t), big = std::sqrt(1 - t);
  const double alpha = 2 * kPi * s / kPhi, beta = 2 * kPi * s / kPsi;
  return Eigen::Quaterniond(big * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha), big * std::sin(beta))
      .normalized()
      .toRotationMatrix();
}

double angle_between(const Mat3& a, const Mat3& b) {
  return std::acos(std::clamp(0.5 * ((a.transpose() * b).trace() - 1), -1.0, 1.0));
}

bool better(const RotationMatch& a, const RotationMatch& b) {
  return a.correlation > b.correlation;
}

/// Climbs by turning about the three axes by ever smaller steps.
RotationMatch climbed(const SampledSphere& a, const SphereMap& b, RotationMatch match, double first_step,
                      double last_step) {
  match.correlation = a.correlation(b, match.a_from_b);
  for (double step = first_step; step > last_step; step *= 0.5) {
    constexpr int kMostRounds = 12;
    bool moved = true;
    for (int round = 0; moved && round < kMostRounds; ++round) {
      moved = false;
      for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          const Mat3 turned = Eigen::AngleAxisd(sign * step, Vec3::Unit(axis)).toRotationMatrix() * match.a_from_b;
          const double c = a.correlation(b, turned);
          if (c <= match.correlation) continue;
          match.a_from_b = turned;
          match.correlation = c;
          moved = true;
        }
      }
    }
  }
  return match;
}

/// The best, none within `apart` of a better one.
std::vector<RotationMatch> distinct(std::vector<RotationMatch> matches, std::size_t most, double apart) {
  std::stable_sort(matches.begin(), matches.end(), better);
  std::vector<RotationMatch> kept;
  for (const RotationMatch& m : matches) {
    if (kept.size() >= most) break;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const RotationMatch& k) {
      return angle_between(k.a_from_b, m.a_from_b) < apart;
    });
    if (!known) kept.push_back(m);
  }
  return kept;
}

std::vector<RotationMatch> climb_all(const SampledSphere& a, const SphereMap& b, std::vector<RotationMatch> matches,
                                     double first_step, double last_step) {
  for_rows(static_cast<int>(matches.size()), 1, [&](int k, int) {
    RotationMatch& match = matches[static_cast<std::size_t>(k)];
    match = climbed(a, b, match, first_step, last_step);
  });
  return matches;
}

BallView at_distance(const BallView& view, double inverse_distance) {
  BallView result = view;
  if (!view.distance_known)
    result.ball.distance = inverse_distance > 0 ? 1 / inverse_distance : std::numeric_limits<double>::infinity();
  return result;
}

double inverse_of(double distance) {
  return std::isinf(distance) ? 0 : 1 / distance;
}

/// One view's maps as from several distances, each made when it is first asked for.
class MapsOfDistance {
 public:
  MapsOfDistance(const BallView& view, int width)
      : view_(view), width_(width), picture_(log_view(view, SphereMap::radius_for(width))) {}
  const SphereMap& operator()(double inverse_distance) {
    const BallView seen = at_distance(view_, inverse_distance);
    const double inverse = inverse_of(seen.ball.distance);
    const auto known = maps_.find(inverse);
    return known != maps_.end() ? known->second
                                : maps_.emplace(inverse, SphereMap(seen, picture_, width_)).first->second;
  }
  double distance(double inverse_distance) const { return at_distance(view_, inverse_distance).ball.distance; }

 private:
  const BallView& view_;
  int width_;
  LogView picture_;
  std::map<double, SphereMap> maps_;
};

/// Everywhere, coarsely; the best of it refined once.
std::vector<RotationMatch> coarse_matches(const BallView& a, const BallView& b) {
  constexpr int kRotations = 60000;  // 6 degrees apart
  constexpr int kWidth = 64;
  const SphereMap map_a(a, kWidth), map_b(b, kWidth);
  const SampledSphere few(map_a, even_directions(400)), more(map_a, even_directions(1500));
  std::vector<RotationMatch> matches(kRotations);
  for_rows(kRotations, 500, [&](int first, int last) {
    for (int k = first; k < last; ++k) {
      RotationMatch& match = matches[static_cast<std::size_t>(k)];
      match.a_from_b = spread_rotation(k, kRotations);
      match.correlation = few.correlation(map_b, match.a_from_b);
    }
  });
  matches = distinct(std::move(matches), 60, 7 * kDegree);
  return distinct(climb_all(more, map_b, std::move(matches), 3 * kDegree, 0.7 * kDegree), 8, 4 * kDegree);
}

}  // namespace

std::vector<RotationMatch> match_rotations(const BallView& a, const BallView& b) {
  constexpr int kWidth = 192;
  constexpr double kTypical = 0.07;  ///< inverse distance of a camera at 14 radii
  constexpr std::size_t kMost = 3;
  constexpr double kApart = 10 * kDegree;
  const std::vector<RotationMatch> starts = coarse_matches(at_distance(a, kTypical), at_distance(b, kTypical));
  const std::vector<Vec3> many = even_directions(6000);
  const bool known = a.distance_known && b.distance_known;
  MapsOfDistance maps_a(a, kWidth), maps_b(b, kWidth);
  // Each start keeps the distances that suit it best.
  std::vector<RotationMatch> best(starts.size());
  const auto consider = [&](double inverse_a, double inverse_b, const std::vector<RotationMatch>& from,
                            double first_step) {
    const SampledSphere seen_a(maps_a(inverse_a), many);
    const std::vector<RotationMatch> climbed = climb_all(seen_a, maps_b(inverse_b), from, first_step, 0.3 * kDegree);
    for (std::size_t k = 0; k < climbed.size(); ++k) {
      if (climbed[k].correlation <= best[k].correlation) continue;
      best[k] = climbed[k];
      best[k].distance_a = maps_a.distance(inverse_a);
      best[k].distance_b = maps_b.distance(inverse_b);
    }
  };
  // One distance for both, where it is not known; then each for itself.
  for (const double inverse : {kTypical, 0.0, 0.035, 0.11, 0.16, 0.22}) {
    consider(inverse, inverse, starts, 2.4 * kDegree);
    if (known) break;
  }
  best = distinct(std::move(best), kMost, kApart);
  if (known) return best;
  const std::vector<RotationMatch> few = best;
  std::vector<RotationMatch> finished;
  for (const RotationMatch& match : few) {
    best = {match};
    for (const bool of_a : {true, false}) {
      for (const double change : {-0.04, 0.04}) {
        const RotationMatch from = best.front();
        consider(inverse_of(from.distance_a) + (of_a ? change : 0), inverse_of(from.distance_b) + (of_a ? 0 : change),
                 {from}, 1.2 * kDegree);
      }
    }
    finished.push_back(best.front());
  }
  return distinct(std::move(finished), kMost, kApart);
}

}  // namespace hdr::internal
