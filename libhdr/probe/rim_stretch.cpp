#include "libhdr/probe/internal/rim_stretch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libhdr/core/sphere.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/luminance.h"

namespace hdr::internal {
namespace {

constexpr double kFromRim = 2.5;     ///< pixels that stay clear of the rim and its blur
constexpr double kAcross = 2;        ///< pixels over which the change along the radius is taken
constexpr double kMostChange = 2.4;  ///< ln that one change may count: a lamp's edge is not all there is
/// Pixels over which the change along the ring is taken.
constexpr std::array kSteps{1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 11.3, 16.0, 22.6, 32.0, 45.0, 64.0};
constexpr std::size_t kStepAcross = 1;  ///< of them the one that is kAcross

/// How much log luminance changes on one ring: mean sizes, in which few large changes, such as a horizon's, count
/// little.
struct Ring {
  double r = 0;  ///< of the radius
  double across = 0;
  std::array<double, kSteps.size()> along{};
  bool seen = false;
};

double bounded_root(double change) {
  return std::sqrt(std::min(std::abs(change), kMostChange));
}

Ring ring_at(View<const float> picture, const Ellipse& outline, double r) {
  const double radius = r * outline.minor;
  const int count = std::max(8, static_cast<int>(2 * kPi * radius));
  const double pixel = 2 * kPi * radius / count;
  const Vec2 aside(-outline.along.y(), outline.along.x());
  const double longer = outline.major / outline.minor;
  std::vector<double> values, changes;
  for (int k = 0; k < count; ++k) {
    const double azimuth = 2 * kPi * k / count;
    const Vec2 unit = longer * std::cos(azimuth) * outline.along + std::sin(azimuth) * aside;
    const auto value = [&](double out) {
      return std::log(std::max(bilinear(picture, outline.centre + out * unit), 1e-30));
    };
    const Vec2 px = outline.centre + (radius + 1) * unit;
    values.push_back(value(radius));
    if (!(px.x() > 1 && px.y() > 1 && px.x() < picture.width() - 1 && px.y() < picture.height() - 1)) continue;
    changes.push_back(value(radius + 0.5 * kAcross) - value(radius - 0.5 * kAcross));
  }
  Ring ring{r};
  ring.seen = 2 * static_cast<int>(changes.size()) >= count;
  if (!ring.seen) return ring;
  double own = 0;  // what is the same all around is a ring's or a lamp's
  for (const double change : changes) own += change / static_cast<double>(changes.size());
  for (const double change : changes) ring.across += bounded_root(change - own);
  ring.across = std::pow(ring.across / static_cast<double>(changes.size()), 2);
  const auto on_ring = [&](double place) {
    const double p = std::fmod(place + 2.0 * count, static_cast<double>(count));
    const int left = static_cast<int>(p) % count;
    const double f = p - std::floor(p);
    return (1 - f) * values[static_cast<std::size_t>(left)] + f * values[static_cast<std::size_t>((left + 1) % count)];
  };
  for (std::size_t j = 0; j < kSteps.size(); ++j) {
    const double half = 0.5 * kSteps[j] / pixel;
    for (int k = 0; k < count; ++k) ring.along[j] += bounded_root(on_ring(k + half) - on_ring(k - half));
    ring.along[j] = std::pow(ring.along[j] / count, 2);
  }
  return ring;
}

double without_noise(double change, double floor) {
  return std::sqrt(std::max(0.0, change * change - floor * floor));
}

/// ln of the step along a ring over which light changes as much as over kAcross along the radius.
double lengthening(const Ring& ring, double across, double floor) {
  constexpr double kLeast = -2.5, kBeyond = 0.3, kTiny = 1e-12;
  double before = 0;
  for (std::size_t j = 0; j < kSteps.size(); ++j) {
    const double change = std::max({before, kTiny, without_noise(ring.along[j], floor)});
    if (change >= across) {
      if (j == 0) return std::max(kLeast, std::log(kSteps[0] / kAcross * across / change));
      const double from = std::log(std::max(before, kTiny)), to = std::log(change);
      const double f = to > from ? (std::log(across) - from) / (to - from) : 0;
      return std::log(kSteps[j - 1] / kAcross) + f * std::log(kSteps[j] / kSteps[j - 1]);
    }
    before = change;
  }
  return std::log(kSteps.back() / kAcross) + kBeyond;
}

/// Weighted least squares of a straight line.
class Line {
 public:
  void add(double weight, double x, double y) {
    w_ += weight;
    x_ += weight * x;
    y_ += weight * y;
    xx_ += weight * x * x;
    xy_ += weight * x * y;
  }
  double slope() const {
    const double divisor = w_ * xx_ - x_ * x_;
    return divisor > 1e-6 ? (w_ * xy_ - x_ * y_) / divisor : 0;
  }
  double at(double x) const { return w_ > 0 ? (y_ - slope() * x_) / w_ + slope() * x : 0; }
  double weight() const { return w_; }

 private:
  double w_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0;
};

}  // namespace

RimStretch rim_stretch(View<const float> luminance, const Ellipse& outline, double noise) {
  constexpr double kFirst = 0.4, kLast = 0.985, kStep = 0.02;
  constexpr double kLeastPattern = 0.05, kDarkest = 1e-4;
  constexpr double kReference = 2;  // ln of a sphere's lengthening
  // The mean size of noise's changes: bilinear readings have two thirds of a pixel's noise.
  const double floor = 0.8 * noise * 0.67 * std::sqrt(2.0);
  Line lengthenings, changes;
  int rings = 0;
  for (double r = kFirst; r < kLast && (1 - r) * outline.minor >= kFromRim; r += kStep) {
    const Ring ring = ring_at(luminance, outline, r);
    if (!ring.seen) continue;
    ++rings;
    const double across = without_noise(ring.across, floor);
    const double weight = std::pow(across / std::max(ring.across, 1e-30), 2);
    if (weight < kLeastPattern) continue;
    const double expected = -std::log(1 - r * r);
    lengthenings.add(weight, expected, lengthening(ring, across, floor));
    changes.add(weight, expected, std::log(std::max(kDarkest, without_noise(ring.along[kStepAcross], floor))));
  }
  if (rings == 0) return {};
  return {lengthenings.at(kReference) / kReference, lengthenings.at(0), -changes.slope(),
          lengthenings.weight() / rings};
}

bool is_mirrored(const RimStretch& rim) {
  // Measured on simulated balls in real places and on other round things.
  constexpr double kLeastMirrored = 0.74, kMostStretch = 1.5, kLeastPatterned = 0.85;
  constexpr double kMostInMiddle = 1, kLeastSpread = -0.35, kMostSpread = 0.9;
  // Of 400 balls a few lay beyond these bounds by up to a tenth, all of them plainly stretched and without noise, which
  // of 190 other things in those bounds none was.
  constexpr double kPlainStretch = 1.1, kPlainlyPatterned = 0.9, kLeeway = 0.15;
  // What lengthens the middle lengthens the rim alike, which of painted things with long middles none has.
  const double leeway = rim.stretch >= kPlainStretch && rim.patterned >= kPlainlyPatterned ? kLeeway : 0;
  // Before a shore or under clouds a ball's stretch may fall to a painted globe's, whose rise is .7 at most.
  constexpr double kLeastByRise = 0.85, kSpreads = 0.1;
  const bool rises =
      rim.mirrored_by_rise() >= kLeastByRise && rim.spread >= kSpreads && rim.patterned >= kPlainlyPatterned;
  return rim.patterned >= kLeastPatterned && (rim.mirrored() >= kLeastMirrored || rises) &&
         rim.stretch <= kMostStretch + leeway && std::abs(rim.in_middle) <= kMostInMiddle + 2 * leeway &&
         rim.spread >= kLeastSpread - leeway && rim.spread <= kMostSpread + leeway;
}

}  // namespace hdr::internal
