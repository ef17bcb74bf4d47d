// Fisheye lenses, and the other discs that are symmetric about an axis.
#include <algorithm>
#include <cmath>
#include <utility>

#include "libhdr/core/sphere.h"
#include "libhdr/probe/projection.h"

namespace hdr {
namespace {

constexpr std::array<std::pair<const char*, Lens>, 6> kLenses = {{{"equidistant", Lens::kEquidistant},
                                                                  {"equisolid", Lens::kEquisolid},
                                                                  {"stereographic", Lens::kStereographic},
                                                                  {"orthographic", Lens::kOrthographic},
                                                                  {"polynomial", Lens::kPolynomial},
                                                                  {"kannala-brandt", Lens::kKannalaBrandt}}};

/// The angle at which a rising function has this value: bisection, closed by Newton's steps with a secant's slope.
double angle_from_radius(const Fisheye& lens, double radius, double most) {
  constexpr int kMostSteps = 80;
  double low = 0, high = most;
  double f_low = -radius, f_high = lens.radius_from_angle(most) - radius;
  if (f_high <= 0) return most;
  for (int step = 0; step < kMostSteps && high - low > 1e-15 * most; ++step) {
    // Regula falsi where it moves on, the middle every third step so that both ends do.
    double theta = step % 3 == 2 ? 0.5 * (low + high) : low - f_low * (high - low) / (f_high - f_low);
    theta = std::clamp(theta, low, high);
    const double f = lens.radius_from_angle(theta) - radius;
    if (f == 0) return theta;
    (f < 0 ? low : high) = theta;
    (f < 0 ? f_low : f_high) = f;
  }
  return -f_low < f_high ? low : high;
}

}  // namespace

const char* name_of(Lens lens) {
  for (const auto& [name, value] : kLenses) {
    if (value == lens) return name;
  }
  return kLenses[0].first;
}

std::optional<Lens> lens_from_name(const std::string& name) {
  for (const auto& [known, value] : kLenses) {
    if (name == known) return value;
  }
  return std::nullopt;
}

double Fisheye::radius_from_angle(double theta) const {
  const double t2 = theta * theta;
  switch (lens) {
    case Lens::kEquidistant:
      return theta;
    case Lens::kEquisolid:
      return 2 * std::sin(0.5 * theta);
    case Lens::kStereographic:
      return 2 * std::tan(0.5 * theta);
    case Lens::kOrthographic:
      return std::sin(theta);
    case Lens::kPolynomial:
      return theta * (1 + theta * (k[0] + theta * (k[1] + theta * (k[2] + theta * k[3]))));
    case Lens::kKannalaBrandt:
      return theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
  }
  return theta;
}

std::optional<Vec3> Fisheye::dir_from_px(const Vec2& px) const {
  const double right = (px.x() - disc.cx) / disc.r, up = -(px.y() - disc.cy) / disc.r;
  const double rho = std::hypot(right, up);
  if (rho > 1) return std::nullopt;
  if (rho == 0) return Vec3(0, 0, 1);
  const double most = 0.5 * fov_degrees * kDegree;
  const double radius = rho * radius_from_angle(most);
  double theta = 0;
  switch (lens) {
    case Lens::kEquidistant:
      theta = radius;
      break;
    case Lens::kEquisolid:
      theta = 2 * std::asin(std::min(1.0, 0.5 * radius));
      break;
    case Lens::kStereographic:
      theta = 2 * std::atan(0.5 * radius);
      break;
    case Lens::kOrthographic:
      theta = std::asin(std::min(1.0, radius));
      break;
    default:
      theta = angle_from_radius(*this, radius, most);
  }
  const double across = std::sin(theta) / rho;
  return Vec3(-across * right, across * up, std::cos(theta));
}

std::optional<Vec2> Fisheye::px_from_dir(const Vec3& dir) const {
  constexpr double kRounding = 1e-14;
  const double across = std::hypot(dir.x(), dir.y());
  const double theta = std::atan2(across, dir.z()), most = 0.5 * fov_degrees * kDegree;
  if (theta > most * (1 + kRounding)) return std::nullopt;
  const double rho = disc.r * std::min(1.0, radius_from_angle(theta) / radius_from_angle(most));
  if (across == 0) return Vec2(disc.cx + rho, disc.cy);  // behind the lens: its rightmost point stands for the rim
  return Vec2(disc.cx - rho * dir.x() / across, disc.cy - rho * dir.y() / across);
}

std::optional<Vec3> Hemisphere::dir_from_px(const Vec2& px) const {
  const double right = (px.x() - disc.cx) / disc.r, down = (px.y() - disc.cy) / disc.r;
  const double rho = std::hypot(right, down);
  if (rho > 1) return std::nullopt;
  if (rho == 0) return Vec3(0, 1, 0);
  const double theta = 0.5 * kPi * rho, across = std::sin(theta) / rho;
  return Vec3(-across * right, std::cos(theta), across * down);
}

std::optional<Vec2> Hemisphere::px_from_dir(const Vec3& dir) const {
  if (dir.y() < 0) return std::nullopt;
  const double across = std::hypot(dir.x(), dir.z());
  if (across == 0) return Vec2(disc.cx, disc.cy);
  const double rho = disc.r * std::min(1.0, std::atan2(across, dir.y()) / (0.5 * kPi));
  return Vec2(disc.cx - rho * dir.x() / across, disc.cy + rho * dir.z() / across);
}

/// The paraboloid's disc coordinates (a, b), b down: (a, b) = (right, down) / (1 + cosine), whose inverse is
/// (2 a, 2 b, 1 - a^2 - b^2) / (1 + a^2 + b^2).
std::optional<Vec3> DualParaboloid::dir_from_px(const Vec2& px) const {
  const double r = 0.25 * size.width;
  const bool back = px.x() > 2 * r;
  const double a = (px.x() - (back ? 3 * r : r)) / r, b = (px.y() - r) / r;
  const double rho2 = a * a + b * b;
  if (rho2 > 1) return std::nullopt;
  const double side = back ? -1 : 1;
  return Vec3(-side * 2 * a, -2 * b, side * (1 - rho2)) / (1 + rho2);
}

std::optional<Vec2> DualParaboloid::px_from_dir(const Vec3& dir) const {
  const double r = 0.25 * size.width;
  const bool back = dir.z() < 0;
  const double side = back ? -1 : 1, scale = r / (1 + std::abs(dir.z()));
  return Vec2((back ? 3 * r : r) - side * scale * dir.x(), r - scale * dir.y());
}

}  // namespace hdr
