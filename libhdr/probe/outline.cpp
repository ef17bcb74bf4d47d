#include "libhdr/probe/internal/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/luminance.h"
#include "libhdr/probe/internal/profile_likelihood.h"
#include "libhdr/probe/internal/whitened_squares.h"

namespace hdr::internal {
namespace {

constexpr double kMostEvidence = 30;  ///< that one radius may give: no arc outvotes the circle
constexpr double kMostLoss = 20;      ///< that one radius may lose, off its own best place: blemishes are outvoted
constexpr double kSupports = 3;       ///< evidence from which a radius counts as support

using Vec4 = Eigen::Vector4d;

/// What is seen across the outline, in three ways: the square and the fourth root of luminance, and the difference
/// between the fourth roots of red and of blue, each against its mean there. Roots lie between radiance, in which a
/// blur is a blur but a sun is all there is, and its logarithm, in which a blur is a shift: the lower one sees what is
/// dark beside a bright floor.
constexpr std::size_t kSights = 3;

bool has_say(std::size_t sight, const OutlinePicture& picture) {
  return sight == 0 || !picture.plain;
}

/// The profiles across an outline, a column each.
struct Profiles {
  std::vector<Vec4>
      shift_from_change;  ///< how far it moves outwards there when (cx, cy, both half-axes, the larger) grow
  std::array<SampleRows, kSights> sights{};
  std::array<Eigen::ArrayXd, kSights> without_outline{};  ///< ln likelihood

  std::size_t size() const { return shift_from_change.size(); }
};

/// (v / mean)^power - 1, times what keeps small changes of one size for any power.
Eigen::VectorXf root_of(const Eigen::VectorXd& values, double power) {
  return (((values.array() / std::max(values.mean(), 1e-30)).pow(power) - 1) * (0.5 / power)).cast<float>();
}

/// Variance of a sight's noise for pixels of this deviation.
double noise_floor(double noise, std::size_t sight) {
  return (sight == 2 ? 2 : 1) * noise * noise;
}

/// Where the outline lies in the picture. Beyond the frame the last pixels go on.
Profiles read_profiles(const OutlinePicture& picture, const Ellipse& outline, int radii, int half_window) {
  constexpr double kInside = 2;  // pixels of the outside that must be seen
  const Vec2 along = outline.along, aside(-along.y(), along.x());
  const Size size = picture.size();
  Profiles profiles;
  const int columns = (radii + kWhitenedColumns - 1) / kWhitenedColumns * kWhitenedColumns;
  profiles.sights.fill(SampleRows::Zero(2 * half_window + 1, columns));
  for (int k = 0; k < radii; ++k) {
    const double angle = 2 * kPi * k / radii, c = std::cos(angle), s = std::sin(angle);
    const Vec2 from_centre = outline.major * c * along + outline.minor * s * aside;
    const Vec2 normal = (outline.minor * c * along + outline.major * s * aside).normalized();
    const auto at = [&](double out) { return Vec2(outline.centre + from_centre + out * normal); };
    const Vec2 seen = at(kInside);
    if (seen.x() < 0 || seen.y() < 0 || seen.x() > size.width || seen.y() > size.height) continue;
    const double longer = c * normal.dot(along), growth = longer + s * normal.dot(aside);
    Eigen::VectorXd luminance(2 * half_window + 1), red(luminance.size()), blue(luminance.size());
    for (int i = 0; i < luminance.size(); ++i) {
      const Vec2 px = at(i - half_window);
      luminance[i] = bilinear(picture.luminance, px);
      red[i] = bilinear(picture.red, px);
      blue[i] = bilinear(picture.blue, px);
    }
    const auto column = static_cast<Eigen::Index>(profiles.size());
    profiles.shift_from_change.emplace_back(normal.x(), normal.y(), growth, longer);
    profiles.sights[0].col(column) = root_of(luminance, 0.5);
    if (picture.plain) continue;
    profiles.sights[1].col(column) = root_of(luminance, 0.25);
    profiles.sights[2].col(column) = root_of(red, 0.25) - root_of(blue, 0.25);
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

/// Of each sight in the evidence of each radius: both of luminance are of one light; colour has a say as far as it
/// changes by more than its noise, which is about the same in red and in blue, and greater than that of luminance.
std::array<Eigen::ArrayXd, kSights> shares_of(const Profiles& profiles, const OutlinePicture& picture) {
  const Eigen::Index count = static_cast<Eigen::Index>(profiles.size());
  const auto constant = [&](double value) { return Eigen::ArrayXd::Constant(count, value); };
  if (picture.plain) return {constant(1), constant(0), constant(0)};
  constexpr double kChannel = 1.5;  // noise of a channel against that of luminance
  const double variance = 2 * 0.25 * kChannel * kChannel * picture.noise * picture.noise;
  const Eigen::MatrixXd colour = profiles.sights[2].leftCols(count).cast<double>();
  const Eigen::ArrayXd mean = colour.colwise().mean().transpose();
  const Eigen::ArrayXd spread =
      colour.colwise().squaredNorm().transpose().array() / static_cast<double>(colour.rows()) - mean.square();
  return {constant(0.5), constant(0.5), (1 - 3 * variance / spread.max(1e-30)).max(0)};
}

/// What the radii say of an outline at each shift, under one clock.
class Evidence {
 public:
  Evidence(const Profiles& profiles, const std::vector<ProfileLikelihood>& outline, const OutlineSearch& search,
           const OutlinePicture& picture)
      : range_(search.range_px), step_(search.step_px) {
    for (const Vec4& shift_from_change : profiles.shift_from_change) {
      radii_.push_back({shift_from_change, std::vector<double>(outline.size())});
    }
    const std::array<Eigen::ArrayXd, kSights> shares = shares_of(profiles, picture);
    const auto count = static_cast<Eigen::Index>(profiles.size());
    for (std::size_t k = 0; k < kSights; ++k) {
      if (!has_say(k, picture)) continue;
      for (std::size_t s = 0; s < outline.size(); ++s) {
        const Eigen::ArrayXd gain = shares[k] * (outline[s](profiles.sights[k], count, noise_floor(picture.noise, k)) -
                                                 profiles.without_outline[k]);
        for (std::size_t r = 0; r < radii_.size(); ++r) {
          radii_[r].evidence[s] += gain[static_cast<Eigen::Index>(r)];
        }
      }
    }
    for (Radius& radius : radii_) {
      const double best = *std::max_element(radius.evidence.begin(), radius.evidence.end());
      for (double& e : radius.evidence) e = std::min(best, kMostEvidence) + std::max(e - best, -kMostLoss);
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
    fit.octants = {};
    for (const Radius& radius : radii_) {
      const double here = shift_of(radius, change);
      fit.octants[octant_of(radius.shift_from_change)] += at(radius, here);
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

  static std::size_t octant_of(const Vec4& out) {
    return static_cast<std::size_t>(std::floor((std::atan2(out[1], out[0]) + kPi) / kPi * 4)) % 8;
  }
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

/// The ways to go from a place: along each axis, and along each diagonal, since a side of the outline that tells
/// nothing leaves a ridge of circles that differ in centre and radius at once.
std::vector<Vec4> ways_to_go(bool elongates) {
  std::vector<Vec4> ways;
  for (int code = 0; code < 81; ++code) {
    Vec4 way(code % 3 - 1, code / 3 % 3 - 1, code / 9 % 3 - 1, code / 27 - 1);
    if (way.isZero() || (!elongates && way[3] != 0)) continue;
    way[2] -= 0.5 * way[3];  // longer one way, the other way shorter
    ways.push_back(way);
  }
  return ways;
}

struct Summit {
  double evidence = -std::numeric_limits<double>::infinity();
  Vec4 change = Vec4::Zero();
};

/// By ever smaller steps.
Summit climbed(const Evidence& evidence, Summit from, double range, const std::vector<Vec4>& ways) {
  for (double step = 0.5; step > 0.01; step *= 0.5) {
    for (bool moved = true; moved;) {
      moved = false;
      Summit best = from;
      for (const Vec4& way : ways) {
        const Vec4 change = from.change + step * way;
        if (change.cwiseAbs().maxCoeff() > range) continue;
        if (const double e = evidence.mean(change); e > best.evidence) best = {e, change};
      }
      moved = best.evidence > from.evidence;
      from = best;
    }
  }
  return from;
}

/// The places of a coarse grid with the most evidence, the best first.
std::vector<Summit> best_of_grid(const Evidence& evidence, double range, bool elongates, std::size_t count) {
  constexpr double kCoarse = 1;
  std::vector<Summit> grid;
  const double longest = elongates ? range : 0;
  for (double longer = -longest; longer <= longest; longer += 2 * kCoarse) {
    for (double dr = -range; dr <= range; dr += kCoarse) {
      for (double dx = -range; dx <= range; dx += kCoarse) {
        for (double dy = -range; dy <= range; dy += kCoarse) {
          if (std::abs(dr + 0.5 * longer) + std::hypot(dx, dy) > range) continue;
          const Vec4 change(dx, dy, dr, longer);
          grid.push_back({evidence.mean(change), change});
        }
      }
    }
  }
  const auto more = [](const Summit& a, const Summit& b) { return a.evidence > b.evidence; };
  count = std::min(count, grid.size());
  std::partial_sort(grid.begin(), grid.begin() + static_cast<std::ptrdiff_t>(count), grid.end(), more);
  grid.resize(count);
  return grid;
}

}  // namespace

OutlineModel::OutlineModel(const OutlineSearch& search)
    : search_(search), tables_(std::make_shared<const Tables>(search)) {}

OutlineFit OutlineModel::fit(const OutlinePicture& picture, const Ellipse& guess, bool elongates,
                             std::vector<std::size_t> clocks) const {
  Profiles profiles = read_profiles(picture, guess, search_.radii, tables_->half_window);
  OutlineFit fit;
  fit.in_frame = static_cast<double>(profiles.size()) / search_.radii;
  fit.radii = static_cast<int>(profiles.size());
  fit.outline = guess;
  if (profiles.size() == 0) return fit;
  for (std::size_t k = 0; k < kSights; ++k) {
    if (!has_say(k, picture)) continue;
    Eigen::ArrayXd& best = profiles.without_outline[k];
    best =
        Eigen::ArrayXd::Constant(static_cast<Eigen::Index>(profiles.size()), -std::numeric_limits<double>::infinity());
    for (const ProfileLikelihood& without : tables_->without) {
      best = best.max(without(profiles.sights[k], best.size(), noise_floor(picture.noise, k)));
    }
  }
  // Only the clocks that the grid finds best are looked at closely.
  constexpr std::size_t kClocks = 3;
  struct Candidate {
    std::size_t clock;
    Evidence evidence;
    std::vector<Summit> starts;
  };
  if (clocks.empty()) {
    clocks.resize(tables_->with.size());
    std::iota(clocks.begin(), clocks.end(), std::size_t{0});
  }
  std::vector<std::optional<Candidate>> made(clocks.size());
  for_rows(static_cast<int>(clocks.size()), 1, [&](int k, int) {
    const std::size_t clock = clocks[static_cast<std::size_t>(k)];
    Evidence evidence(profiles, tables_->with[clock], search_, picture);
    std::vector<Summit> starts = best_of_grid(evidence, search_.range_px, elongates, search_.starts);
    made[static_cast<std::size_t>(k)] = {clock, std::move(evidence), std::move(starts)};
  });
  std::vector<Candidate> candidates;
  for (auto& each : made) candidates.push_back(std::move(*each));
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.starts.front().evidence > b.starts.front().evidence;
  });
  candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(std::min(kClocks, candidates.size())),
                   candidates.end());
  for (const Candidate& candidate : candidates) fit.clocks.push_back(candidate.clock);
  const std::vector<Vec4> ways = ways_to_go(elongates);
  const std::size_t starts = candidates.front().starts.size();  // the same of each
  std::vector<Summit> summits(candidates.size() * starts);
  for_rows(static_cast<int>(summits.size()), 1, [&](int first, int) {
    const auto k = static_cast<std::size_t>(first);
    const Candidate& candidate = candidates[k / starts];
    summits[k] = climbed(candidate.evidence, candidate.starts[k % starts], search_.range_px, ways);
  });
  const auto highest = std::max_element(summits.begin(), summits.end(),
                                        [](const Summit& a, const Summit& b) { return a.evidence < b.evidence; });
  const Summit& best = *highest;
  const auto clock = static_cast<std::size_t>(highest - summits.begin()) / starts;
  fit.evidence = best.evidence;
  const Vec4& change = best.change;
  fit.outline = {guess.centre + change.head<2>(), guess.along, guess.major + change[2] + change[3],
                 guess.minor + change[2]};
  candidates[clock].evidence.judge(change, fit);
  return fit;
}

}  // namespace hdr::internal
