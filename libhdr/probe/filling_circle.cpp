#include "libhdr/probe/internal/filling_circle.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "libhdr/core/sphere.h"
#include "libhdr/core/vec.h"
#include "libhdr/probe/internal/luminance.h"

namespace hdr::internal {
namespace {

constexpr int kSide = 160;  ///< the picture is searched at this size: blur is then a pixel
constexpr double kLeastInFrame = 0.6;
// Of 48 photographs without a ball none has more than .56 of both; balls that fill their frames have .6 to .8.
constexpr double kLeastProminence = 0.58, kLeastSupport = 0.65;
// Balls have .93 or more, a chequered room that passes the other two .55.
constexpr double kLeastAcross = 0.75;
constexpr double kNear = 1.2;  ///< pixels to both sides of an edge

/// A circle's radii, as far as the picture shows what is just outside.
class Radii {
 public:
  Radii(View<const float> log_picture, const Disc& circle, int count) : picture_(log_picture), circle_(circle) {
    for (int k = 0; k < count; ++k) {
      const Vec2 out(std::cos(2 * kPi * k / count), std::sin(2 * kPi * k / count));
      const Vec2 seen = at(out, circle.r + 2);
      if (seen.x() < 0 || seen.y() < 0 || seen.x() > picture_.width() || seen.y() > picture_.height()) continue;
      out_.push_back(out);
    }
    in_frame_ = static_cast<double>(out_.size()) / count;
  }
  const std::vector<Vec2>& directions() const { return out_; }
  double in_frame() const { return in_frame_; }
  /// How much log radiance changes across the circle of radius r.
  double edge(const Vec2& out, double r) const {
    return std::abs(bilinear(picture_, at(out, r + kNear)) - bilinear(picture_, at(out, r - kNear)));
  }
  /// The same along it.
  double change_along(const Vec2& out, double r) const {
    const Vec2 middle = at(out, r), along = kNear * Vec2(-out.y(), out.x());
    return std::abs(bilinear(picture_, middle + along) - bilinear(picture_, middle - along));
  }

 private:
  Vec2 at(const Vec2& out, double r) const { return Vec2(circle_.cx, circle_.cy) + r * out; }

  View<const float> picture_;
  Disc circle_;
  std::vector<Vec2> out_;
  double in_frame_ = 0;
};

/// How much the edges along a circle stand out from those a little inside and outside, 0..1; 1/2 is chance.
double prominence(View<const float> log_picture, const Disc& circle) {
  constexpr double kFlat = 0.02;
  const Radii radii(log_picture, circle, 72);
  if (radii.in_frame() < kLeastInFrame) return 0;
  double sum = 0;
  for (const Vec2& out : radii.directions()) {
    double around = 0;
    for (const double away : {-12.0, -9.0, -6.0, 4.0}) around += 0.25 * radii.edge(out, circle.r + away);
    const double here = radii.edge(out, circle.r);
    sum += here / (here + around + kFlat);
  }
  return sum / static_cast<double>(radii.directions().size());
}

/// The most prominent of the circles that fill the frame.
Disc most_prominent(View<const float> log_picture, double& most) {
  const double side = std::min(log_picture.width(), log_picture.height());
  Disc best;
  most = 0;
  for (double r = 0.4 * side; r <= 0.54 * side; r += 1.5) {
    for (double x = -0.08; x < 0.081; x += 0.02) {
      for (double y = -0.08; y < 0.081; y += 0.02) {
        const Disc circle{0.5 * log_picture.width() + x * side, 0.5 * log_picture.height() + y * side, r};
        const double p = prominence(log_picture, circle);
        if (p <= most) continue;
        most = p;
        best = circle;
      }
    }
  }
  return best;
}

/// Where the strongest edge near the circle is along a radius; the nearer the better. nullopt where all is flat.
std::optional<double> edge_offset(const Radii& radii, const Vec2& out, double r, double window) {
  constexpr double kLeastEdge = 0.05, kStep = 0.25;
  double best = kLeastEdge;
  std::optional<double> offset;
  for (double away = -window; away <= window; away += kStep) {
    const double e = radii.edge(out, r + away) * std::exp(-away * away / (window * window));
    if (e <= best) continue;
    best = e;
    offset = away;
  }
  return offset;
}

/// Least squares with Tukey's weights on the strongest edges, closer and closer.
FillingCircle fitted(View<const float> log_picture, Disc circle) {
  constexpr int kRounds = 8, kRadii = 180;
  FillingCircle result;
  for (int round = 0; round < kRounds; ++round) {
    const double window = circle.r * (round < 3 ? 0.10 : 0.06), reach = 0.6 * window;
    const Radii radii(log_picture, circle, kRadii);
    if (radii.in_frame() < 0.5) return {};
    Mat3 normal = 1e-9 * Mat3::Identity();
    Vec3 right = Vec3::Zero();
    int supporting = 0;
    double squares = 0;
    for (const Vec2& out : radii.directions()) {
      const auto offset = edge_offset(radii, out, circle.r, window);
      if (!offset) continue;
      const double u = *offset / reach;
      if (std::abs(u) < 1) {
        const Vec3 row(out.x(), out.y(), 1);
        normal += (1 - u * u) * (1 - u * u) * row * row.transpose();
        right += (1 - u * u) * (1 - u * u) * *offset * row;
      }
      if (std::abs(*offset) > std::max(0.75, 0.015 * circle.r)) continue;
      ++supporting;
      squares += *offset * *offset;
    }
    result = {circle, supporting / static_cast<double>(radii.directions().size()),
              supporting > 0 ? std::sqrt(squares / supporting) : 0};
    const Vec3 change = normal.inverse() * right;
    circle = {circle.cx + change.x(), circle.cy + change.y(), circle.r + change.z()};
  }
  return result;
}

/// The share of the change at the circle's edges that goes across it. An outline has nearly all of it; edges that cross
/// the circle by chance have half.
double share_across(View<const float> log_picture, const Disc& circle) {
  constexpr int kRadii = 180;
  constexpr double kSlack = 0.03;  // of the radius: blur, and outlines that are no circles
  const Radii radii(log_picture, circle, kRadii);
  double across = 0, along = 0;
  for (const Vec2& out : radii.directions()) {
    const auto offset = edge_offset(radii, out, circle.r, std::max(1.0, kSlack * circle.r));
    if (!offset) continue;
    across += std::pow(radii.edge(out, circle.r + *offset), 2);
    along += std::pow(radii.change_along(out, circle.r + *offset), 2);
  }
  return across > 0 ? across / (across + along) : 0;
}

}  // namespace

std::optional<FillingCircle> find_filling_circle(View<const float> luminance) {
  constexpr int kLeastSide = 32;
  std::vector<Image<float>> levels;
  View<const float> level = luminance;
  while (std::max(level.width(), level.height()) > kSide && std::min(level.width(), level.height()) >= 2 * kLeastSide) {
    levels.push_back(halved(level));
    level = levels.back();
  }
  Image<float> log_picture(level.size(), 1);
  for (int y = 0; y < log_picture.height(); ++y) {
    for (int x = 0; x < log_picture.width(); ++x) log_picture(x, y) = std::log(std::max(level(x, y), 1e-30f));
  }
  double most = 0;
  const Disc rough = most_prominent(log_picture, most);
  if (most < kLeastProminence) return std::nullopt;
  FillingCircle found = fitted(log_picture, rough);
  if (found.support < kLeastSupport || share_across(log_picture, found.disc) < kLeastAcross) return std::nullopt;
  const double scale = std::exp2(static_cast<double>(levels.size()));
  found.disc = {scale * found.disc.cx, scale * found.disc.cy, scale * found.disc.r};
  found.residual_px *= scale;
  return found;
}

}  // namespace hdr::internal
