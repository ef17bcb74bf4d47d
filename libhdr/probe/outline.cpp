#include "libhdr/probe/internal/outline.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/luminance.h"

namespace hdr::internal {
namespace {

constexpr double kMostEvidence = 30;  ///< that one radius may give: no arc outvotes the circle
constexpr double kMostLoss = 20;      ///< that one radius may lose, off its own best place: blemishes are outvoted
constexpr double kSupports = 3;       ///< evidence from which a radius counts as support

/// What fraction of a sample's area, at distance u from it and beyond, lies on the far side. Bilinear reading of pixel
/// means sees a blur of deviation 1/2 pixel: a triangle of half-width sqrt(6) / 2.
double share_beyond(double u) {
  constexpr double kHalfWidth = 1.2247;
  const double t = std::clamp(u / kHalfWidth, -1.0, 1.0);
  return t < 0 ? 1 - 0.5 * (1 + t) * (1 + t) : 0.5 * (1 - t) * (1 - t);
}

/// How fast radiance wanders along a radius.
struct Clock {
  bool outline;    ///< inside the clock runs as the square root of the distance to the rim
  double step;     ///< expected size of a step at the rim
  double outside;  ///< variance a pixel outside, against 1 for the first pixel inside
  double noise;    ///< variance of a pixel, likewise
};

/// Covariance of a profile's samples: a random walk from the rim to both sides (natural pictures' spectra fall as those
/// of random walks do), averaged over each sample's area.
Eigen::MatrixXd covariance(const Clock& clock, int half_window, double shift) {
  constexpr double kStep = 0.1;
  const int n = 2 * half_window + 1;
  const int steps = static_cast<int>((half_window + std::abs(shift) + 2) / kStep);
  // The walk's steps, each scaled by its deviation, as seen by each sample.
  Eigen::MatrixXd seen(n, 2 * steps + 5);
  for (int i = 0; i < n; ++i) {
    const double x = i - half_window - shift;  // positive outside
    for (int j = 0; j < steps; ++j) {
      const double from = j * kStep, to = from + kStep;
      const double inside = clock.outline ? std::sqrt(to) - std::sqrt(from) : clock.outside * kStep;
      seen(i, 2 * j) = std::sqrt(inside) * share_beyond(x + from + 0.5 * kStep);
      seen(i, 2 * j + 1) = std::sqrt(clock.outside * kStep) * share_beyond(from + 0.5 * kStep - x);
    }
    // No surprise at all: any level, a step, an even slope outside; without an outline an even bend throughout.
    seen(i, 2 * steps) = 100;
    seen(i, 2 * steps + 1) = clock.step * share_beyond(x);
    seen(i, 2 * steps + 2) = clock.outline ? 0.1 * std::max(x, 0.0) : 0.1 * x;
    seen(i, 2 * steps + 3) = clock.outline ? 0 : 0.02 * x * x;
    seen(i, 2 * steps + 4) = clock.outline ? 0 : 0.004 * x * x * x;
  }
  return seen * seen.transpose() + clock.noise * Eigen::MatrixXd::Identity(n, n);
}

/// ln likelihood of profiles whose covariance is known up to its scale.
class ProfileLikelihood {
 public:
  ProfileLikelihood(const Clock& clock, int half_window, double shift) {
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance(clock, half_window, shift));
    const Eigen::MatrixXd lower = factor.matrixL();
    half_log_determinant_ = lower.diagonal().array().log().sum();
    whitening_ = factor.matrixL().solve(Eigen::MatrixXd::Identity(lower.rows(), lower.cols()));
  }
  double operator()(const Eigen::VectorXd& profile, double floor) const {
    const double n = static_cast<double>(profile.size());
    return -0.5 * n * std::log((whitening_ * profile).squaredNorm() + floor) - half_log_determinant_;
  }

 private:
  Eigen::MatrixXd whitening_;
  double half_log_determinant_;
};

/// How the picture wanders is not known beforehand: these are tried, one for all the radii of a circle.
std::vector<Clock> outline_clocks() {
  std::vector<Clock> result;
  for (const double outside : {1e-4, 1e-3, 1e-2, 0.1, 1.0}) {
    for (const double noise : {1e-4, 1e-2}) result.push_back({true, 0.5, outside, noise});
  }
  return result;
}

/// What else a radius may cross, each for itself: nothing, or the edge of something that is no mirror.
std::vector<ProfileLikelihood> other_likelihoods(int half_window, int range) {
  std::vector<ProfileLikelihood> result;
  const auto add = [&](double step, double wander, double noise, int shift) {
    result.emplace_back(Clock{false, step, wander, noise}, half_window, shift);
  };
  for (const double noise : {1e-3, 1e-1}) {
    for (const double wander : {1e-3, 1.0}) add(0, wander, noise, 0);
    for (int shift = -range; shift <= range; ++shift) {
      for (const double step : {3.0, 30.0}) add(step, 1, noise, shift);
    }
  }
  return result;
}

using Vec4 = Eigen::Vector4d;

/// The square root of radiance across the outline, against its mean there, less 1: between radiance, in which a sun's
/// blur is a blur but the sun is all there is, and its logarithm, in which a blur is a shift.
struct Profile {
  Vec4 shift_from_change;  ///< how far the outline moves outwards here when (cx, cy, both half-axes, the larger) grow
  Eigen::VectorXd values;
  double without_outline = 0;  ///< ln likelihood
};

/// The profiles across an outline, where it lies in the picture. Beyond the frame the last pixels go on.
std::vector<Profile> read_profiles(View<const float> picture, const Ellipse& outline, int radii, int half_window) {
  constexpr double kInside = 2;  // pixels of the outside that must be seen
  const Vec2 along = outline.along, aside(-along.y(), along.x());
  std::vector<Profile> profiles;
  for (int k = 0; k < radii; ++k) {
    const double angle = 2 * kPi * k / radii, c = std::cos(angle), s = std::sin(angle);
    const Vec2 from_centre = outline.major * c * along + outline.minor * s * aside;
    const Vec2 normal = (outline.minor * c * along + outline.major * s * aside).normalized();
    const auto at = [&](double out) { return Vec2(outline.centre + from_centre + out * normal); };
    const Vec2 seen = at(kInside);
    if (seen.x() < 0 || seen.y() < 0 || seen.x() > picture.width() || seen.y() > picture.height()) continue;
    const double longer = c * normal.dot(along), growth = longer + s * normal.dot(aside);
    Profile profile{{normal.x(), normal.y(), growth, longer}, Eigen::VectorXd(2 * half_window + 1)};
    for (int i = 0; i < profile.values.size(); ++i) profile.values[i] = bilinear(picture, at(i - half_window));
    profile.values = (profile.values.array() / std::max(profile.values.mean(), 1e-30)).sqrt() - 1;
    profiles.push_back(std::move(profile));
  }
  return profiles;
}

}  // namespace

/// Likelihoods of a profile without an outline, and with one at each shift, for each clock.
struct OutlineModel::Tables {
  explicit Tables(const OutlineSearch& search)
      : half_window(search.half_window_px + static_cast<int>(std::ceil(search.range_px))),
        without(other_likelihoods(half_window, static_cast<int>(search.range_px))) {
    const int shifts = static_cast<int>(std::ceil(2 * search.range_px / search.step_px)) + 1;
    for (const Clock& clock : outline_clocks()) {
      auto& outline = with.emplace_back();
      for (int s = 0; s < shifts; ++s) outline.emplace_back(clock, half_window, s * search.step_px - search.range_px);
    }
  }
  int half_window;
  std::vector<ProfileLikelihood> without;
  std::vector<std::vector<ProfileLikelihood>> with;
};

namespace {

/// What the radii say of an outline at each shift, under one clock.
class Evidence {
 public:
  Evidence(const std::vector<Profile>& profiles, const std::vector<ProfileLikelihood>& outline,
           const OutlineSearch& search)
      : range_(search.range_px), step_(search.step_px) {
    const double floor = search.noise * search.noise;
    for (const Profile& profile : profiles) {
      Radius radius{profile.shift_from_change, {}};
      for (const ProfileLikelihood& likelihood : outline) {
        radius.evidence.push_back(likelihood(profile.values, floor) - profile.without_outline);
      }
      const double best = *std::max_element(radius.evidence.begin(), radius.evidence.end());
      for (double& e : radius.evidence) e = std::min(best, kMostEvidence) + std::max(e - best, -kMostLoss);
      radii_.push_back(std::move(radius));
    }
  }

  /// Mean evidence for the guess changed by (cx, cy, both half-axes, the larger).
  double mean(const Vec4& change) const {
    double total = 0;
    for (const Radius& radius : radii_) total += at(radius, shift_of(radius, change));
    return radii_.empty() ? 0 : total / static_cast<double>(radii_.size());
  }

  /// Fills in what the radii say one by one.
  void judge(const Vec4& change, OutlineFit& fit) const {
    int supporting = 0;
    double squares = 0;
    for (const Radius& radius : radii_) {
      const double here = shift_of(radius, change);
      double best = here;
      for (double s = here - 1.5; s <= here + 1.5; s += 0.125) {
        if (at(radius, s) > at(radius, best)) best = s;
      }
      if (at(radius, best) < kSupports) continue;
      ++supporting;
      squares += (best - here) * (best - here);
    }
    fit.support = radii_.empty() ? 0 : supporting / static_cast<double>(radii_.size());
    fit.residual_px = supporting > 0 ? std::sqrt(squares / supporting) : 0;
  }

 private:
  struct Radius {
    Vec4 shift_from_change;
    std::vector<double> evidence;  ///< one a shift
  };

  static double shift_of(const Radius& radius, const Vec4& change) { return radius.shift_from_change.dot(change); }
  double at(const Radius& radius, double shift) const {
    const double position =
        std::clamp((shift + range_) / step_, 0.0, static_cast<double>(radius.evidence.size()) - 1.001);
    const auto index = static_cast<std::size_t>(position);
    const double f = position - static_cast<double>(index);
    return (1 - f) * radius.evidence[index] + f * radius.evidence[index + 1];
  }

  double range_, step_;
  std::vector<Radius> radii_;
};

/// Climbs to the change with the most evidence: every combination of a coarse grid, then ever smaller steps.
Vec4 best_change(const Evidence& evidence, double range, bool elongates) {
  Vec4 best = Vec4::Zero();
  double most = -1e9;
  const auto consider = [&](const Vec4& change) {
    const double e = evidence.mean(change);
    if (e <= most) return false;
    most = e;
    best = change;
    return true;
  };
  constexpr double kCoarse = 1;
  const double longest = elongates ? range : 0;
  for (double longer = -longest; longer <= longest; longer += 2 * kCoarse) {
    for (double dr = -range; dr <= range; dr += kCoarse) {
      for (double dx = -range; dx <= range; dx += kCoarse) {
        for (double dy = -range; dy <= range; dy += kCoarse) {
          if (std::abs(dr + 0.5 * longer) + std::hypot(dx, dy) <= range) consider({dx, dy, dr, longer});
        }
      }
    }
  }
  const int axes = elongates ? 4 : 3;
  for (double step = 0.5 * kCoarse; step > 0.005; step *= 0.5) {
    for (bool moved = true; moved;) {
      moved = false;
      for (int axis = 0; axis < axes; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          Vec4 change = best + sign * step * Vec4::Unit(axis);
          if (axis == 3) change[2] -= 0.5 * sign * step;  // longer one way, the other way shorter
          if (change.cwiseAbs().maxCoeff() <= range) moved = consider(change) || moved;
        }
      }
    }
  }
  return best;
}

}  // namespace

OutlineModel::OutlineModel(const OutlineSearch& search)
    : search_(search), tables_(std::make_shared<const Tables>(search)) {}

OutlineFit OutlineModel::fit(View<const float> luminance, const Ellipse& guess, bool elongates) const {
  std::vector<Profile> profiles = read_profiles(luminance, guess, search_.radii, tables_->half_window);
  OutlineFit fit;
  fit.in_frame = static_cast<double>(profiles.size()) / search_.radii;
  fit.radii = static_cast<int>(profiles.size());
  fit.outline = guess;
  if (profiles.empty()) return fit;
  for (Profile& profile : profiles) {
    profile.without_outline = -std::numeric_limits<double>::infinity();
    for (const ProfileLikelihood& likelihood : tables_->without) {
      profile.without_outline =
          std::max(profile.without_outline, likelihood(profile.values, search_.noise * search_.noise));
    }
  }
  fit.evidence = -std::numeric_limits<double>::infinity();
  for (const auto& outline : tables_->with) {
    const Evidence evidence(profiles, outline, search_);
    const Vec4 change = best_change(evidence, search_.range_px, elongates);
    if (evidence.mean(change) <= fit.evidence) continue;
    fit.evidence = evidence.mean(change);
    fit.outline = {guess.centre + change.head<2>(), guess.along, guess.major + change[2] + change[3],
                   guess.minor + change[2]};
    evidence.judge(change, fit);
  }
  return fit;
}

}  // namespace hdr::internal
