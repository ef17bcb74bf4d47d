#include "libhdr/probe/find_image_circle.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/internal/luminance.h"

namespace hdr {
namespace {

constexpr int kCoarseSide = 512;       ///< the circle is sought in a picture no larger than this
constexpr double kLeastRadius = 0.25;  ///< of the shorter side: a smaller one is a lamp
constexpr double kMostRadius = 1.0;    ///< of the longer side
constexpr double kLeastContrast = 4;   ///< of the light within against the surround
constexpr double kLeastSupport = 0.35;
constexpr double kLeastInFrame = 0.2;
constexpr double kMostStrayLight = 0.02;  ///< share of the surround that flare may light

float percentile(std::vector<float> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Light and darkness of a picture.
struct Levels {
  double dark = 0;   ///< of the surround, with its noise
  double light = 0;  ///< of what is lit: a high percentile, so that a picture half in the dark has it too
};

/// nullopt when fewer than two corners are dark.
std::optional<Levels> levels_of(View<const float> picture) {
  const int patch = std::max(2, std::min(picture.width(), picture.height()) / 50);
  std::vector<float> all, corners;
  for (int y = 0; y < picture.height(); y += 2) {
    for (int x = 0; x < picture.width(); x += 2) all.push_back(picture(x, y));
  }
  for (const int left : {0, picture.width() - patch}) {
    for (const int top : {0, picture.height() - patch}) {
      std::vector<float> corner;
      for (int y = top; y < top + patch; ++y) {
        for (int x = left; x < left + patch; ++x) corner.push_back(picture(x, y));
      }
      corners.push_back(percentile(std::move(corner), 0.9));
    }
  }
  std::sort(corners.begin(), corners.end());
  const Levels levels{corners[1], percentile(std::move(all), 0.8)};
  if (!(levels.light > kLeastContrast * levels.dark) || !(levels.light > 0)) return std::nullopt;
  return levels;
}

/// The first lit place on each way into the picture: from the four sides along rows and columns, and on rays from the
/// border towards the middle.
std::vector<Vec2> first_light(View<const float> picture, double threshold) {
  std::vector<Vec2> points;
  const Vec2 size(picture.width(), picture.height()), middle = 0.5 * size;
  const auto walk = [&](Vec2 at, const Vec2& step) {
    for (bool first = true;; first = false, at += step) {
      const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
      if (x < 0 || y < 0 || x >= picture.width() || y >= picture.height()) return;
      if (picture(x, y) <= threshold) continue;
      if (!first) points.push_back(at - 0.5 * step);  // lit at the border: the rim lies beyond the frame
      return;
    }
  };
  for (int y = 0; y < picture.height(); y += 2) {
    walk({0.5, y + 0.5}, {1, 0});
    walk({picture.width() - 0.5, y + 0.5}, {-1, 0});
  }
  for (int x = 0; x < picture.width(); x += 2) {
    walk({x + 0.5, 0.5}, {0, 1});
    walk({x + 0.5, picture.height() - 0.5}, {0, -1});
  }
  constexpr int kRays = 360;
  for (int k = 0; k < kRays; ++k) {
    const Vec2 out(std::cos(2 * kPi * k / kRays), std::sin(2 * kPi * k / kRays));
    const double reach = std::min((middle.x() - 0.5) / std::max(1e-9, std::abs(out.x())),
                                  (middle.y() - 0.5) / std::max(1e-9, std::abs(out.y())));
    walk(middle + reach * out, -out);
  }
  return points;
}

/// The circle through three points; nullopt when they lie on a line.
std::optional<Disc> circle_through(const Vec2& a, const Vec2& b, const Vec2& c) {
  const Vec2 u = b - a, v = c - a;
  const double twice_area = 2 * (u.x() * v.y() - u.y() * v.x());
  if (std::abs(twice_area) < 1) return std::nullopt;
  const double uu = u.squaredNorm(), vv = v.squaredNorm();
  const Vec2 centre((v.y() * uu - u.y() * vv) / twice_area, (u.x() * vv - v.x() * uu) / twice_area);
  return Disc{a.x() + centre.x(), a.y() + centre.y(), centre.norm()};
}

double distance_outside(const Disc& circle, const Vec2& p) {
  return (p - Vec2(circle.cx, circle.cy)).norm() - circle.r;
}

/// The circle on which most first lights lie. Dark parts put them inside, which costs nothing; light outside costs.
std::optional<Disc> circle_by_consensus(const std::vector<Vec2>& points, Size size) {
  constexpr int kTrials = 3000;
  constexpr double kTolerance = 1.5;
  constexpr std::size_t kFewest = 24;
  if (points.size() < kFewest) return std::nullopt;
  Random random(1, 0xc1c1e);
  const auto pick = [&] {
    return points[std::min(points.size() - 1, static_cast<std::size_t>(random.uniform() * double(points.size())))];
  };
  const double least = kLeastRadius * std::min(size.width, size.height);
  const double most = kMostRadius * std::max(size.width, size.height);
  std::optional<Disc> best;
  double best_score = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto circle = circle_through(pick(), pick(), pick());
    if (!circle || circle->r < least || circle->r > most) continue;
    double score = 0;
    for (const Vec2& p : points) {
      const double outside = distance_outside(*circle, p);
      if (std::abs(outside) < kTolerance) score += 1 - 0.5 * std::abs(outside) / kTolerance;
      if (outside > 2 * kTolerance) score -= 1;
    }
    if (score > best_score) {
      best_score = score;
      best = circle;
    }
  }
  return best_score >= kFewest ? best : std::nullopt;
}

/// Where light begins along a radius: at half the height between what is outside and what is inside, to a part of a
/// pixel.
struct RimPoint {
  Vec2 direction;
  std::optional<double> radius;  ///< nothing where the rim is dark
};

std::vector<RimPoint> rim_points(View<const float> picture, const Disc& circle, double window, double threshold) {
  constexpr int kRadii = 720;
  constexpr double kStep = 0.25;
  std::vector<RimPoint> rim;
  for (int k = 0; k < kRadii; ++k) {
    const double angle = 2 * kPi * k / kRadii;
    RimPoint point{{std::cos(angle), std::sin(angle)}, std::nullopt};
    const auto at = [&](double r) {
      return Vec2(circle.cx + r * point.direction.x(), circle.cy + r * point.direction.y());
    };
    const Vec2 seen = at(circle.r + 1);
    if (seen.x() < 0 || seen.y() < 0 || seen.x() > picture.width() || seen.y() > picture.height()) continue;
    const auto value = [&](double r) { return internal::bilinear(picture, at(r)); };
    // What lies outside may be dark for a shorter way than the window: the least value counts. Inside, the mean.
    double outside = value(circle.r + window), inside = 0;
    for (double r = circle.r; r <= circle.r + window; r += kStep) outside = std::min(outside, value(r));
    for (int i = 0; i < 8; ++i) inside += value(circle.r - window * (0.5 + i / 16.0)) / 8;
    if (inside > threshold && inside > kLeastContrast * outside) {
      const double half = 0.5 * (inside + outside);
      double r = circle.r + window;
      while (r > circle.r - window && value(r) < half) r -= kStep;
      const double above = value(r), below = value(r + kStep);
      if (r > circle.r - window && r < circle.r + window && above > below)
        point.radius = r + kStep * (above - half) / (above - below);
    }
    rim.push_back(point);
  }
  return rim;
}

/// The circle through the rim's points: least squares in which points further than a few deviations have no say.
FoundCircle fitted(const std::vector<RimPoint>& rim, const Disc& start) {
  constexpr int kRounds = 12;
  constexpr double kTukey = 4.685;
  constexpr double kLeastDeviation = 0.15;
  Vec3 change = Vec3::Zero();  // dx, dy, dr
  const auto residual = [&](const RimPoint& p) {
    return *p.radius - (start.r + change.z() + change.head<2>().dot(p.direction));
  };
  double deviation = 1e3;  // the first round is plain least squares
  for (int round = 0; round < kRounds; ++round) {
    Mat3 normal = 1e-9 * Mat3::Identity();
    Vec3 right = Vec3::Zero();
    std::vector<float> sizes;
    for (const RimPoint& p : rim) {
      if (!p.radius) continue;
      const double e = residual(p), u = e / (kTukey * deviation);
      sizes.push_back(static_cast<float>(std::abs(e)));
      if (std::abs(u) >= 1) continue;
      const double w = (1 - u * u) * (1 - u * u);
      const Vec3 row(p.direction.x(), p.direction.y(), 1);
      normal += w * row * row.transpose();
      right += w * e * row;
    }
    if (sizes.empty()) return {};
    change += normal.ldlt().solve(right);
    deviation = std::max(kLeastDeviation, 1.4826 * static_cast<double>(percentile(std::move(sizes), 0.5)));
  }
  FoundCircle found{{start.cx + change.x(), start.cy + change.y(), start.r + change.z()}};
  int supporting = 0, lit = 0;
  double squares = 0;
  for (const RimPoint& p : rim) {
    if (!p.radius) continue;
    ++lit;
    const double e = residual(p);
    if (std::abs(e) > std::max(1.5, 0.005 * start.r)) continue;
    ++supporting;
    squares += e * e;
  }
  found.in_frame = static_cast<double>(rim.size()) / 720;
  // What is lit counts, unless that is little.
  found.support = supporting / std::max(1.0, std::max(1.0 * lit, 0.25 * static_cast<double>(rim.size())));
  found.residual_px = supporting > 0 ? std::sqrt(squares / supporting) : 0;
  return found;
}

/// Share of the pixels well outside the circle that are lit.
double stray_light(View<const float> picture, const Disc& circle, double threshold) {
  double outside = 0, lit = 0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (distance_outside(circle, {x + 0.5, y + 0.5}) < 0.02 * circle.r + 2) continue;
      ++outside;
      if (picture(x, y) > threshold) ++lit;
    }
  }
  return outside > 0 ? lit / outside : 1;
}

/// The circle that bounds what is brighter than the threshold.
std::optional<FoundCircle> circle_at(const std::vector<Image<float>>& levels, double threshold) {
  const Image<float>& coarse = levels.back();
  const auto rough = circle_by_consensus(first_light(coarse, threshold), coarse.size());
  if (!rough || stray_light(coarse, *rough, threshold) > kMostStrayLight) return std::nullopt;
  const double scale = std::exp2(static_cast<double>(levels.size()) - 1);
  FoundCircle found{{scale * rough->cx, scale * rough->cy, scale * rough->r}};
  // Ever closer, down to where the rim of this lens is no longer sharp.
  constexpr double kSharp = 4, kDeviations = 4;
  for (double window = std::max(4 * scale, 0.015 * found.disc.r);; window *= 0.5) {
    found = fitted(rim_points(levels.front(), found.disc, window, threshold), found.disc);
    if (found.support < kLeastSupport || found.in_frame < kLeastInFrame) return std::nullopt;
    if (0.5 * window < std::max(kSharp, kDeviations * found.residual_px)) return found;
  }
}

}  // namespace

std::optional<FoundCircle> find_image_circle(View<const float> picture) {
  constexpr int kLeastSide = 32;
  if (picture.channels() < 1 || std::min(picture.width(), picture.height()) < kLeastSide) return std::nullopt;
  const std::vector<Image<float>> levels = internal::halvings(internal::luminance_of(picture), kCoarseSide, kLeastSide);
  const auto light = levels_of(levels.back());
  if (!light) return std::nullopt;
  // Low thresholds find the rim where it is dark, high ones where the lens's barrel glows around it.
  std::optional<FoundCircle> best;
  for (const double share : {0.03, 0.1, 0.3}) {
    const double threshold = std::max(share * light->light, std::min(2 * light->dark, 0.3 * light->light));
    const auto found = circle_at(levels, threshold);
    if (found && (!best || found->support > best->support)) best = found;
  }
  return best;
}

}  // namespace hdr
