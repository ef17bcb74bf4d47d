#include "capture/virtual/built_in_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

// Metres; x to the right, y up, z away from the camera. The room is a box, its window is in the wall that the camera
// sees.
const Vec3 kRoomMin(-2.6, 0, -3), kRoomMax(2.6, 2.7, 3);
const Vec3 kEye(0, 1.25, -1.6);
constexpr double kWindowLeft = 0.7, kWindowRight = 2.3, kSill = 0.15, kLintel = 2.35;
const Vec3 kToSun = Vec3(1.62, 0.85, 4.6).normalized();
constexpr double kSunCosine = 0.99992;  // 0.7 degrees: a little larger than life, so that small pictures have it
const Rgb kSun(60000, 52000, 40000);
const Rgb kSunlight = kSun * (2 * kPi * (1 - kSunCosine));  // irradiance across the beam
const Rgb kBounce(0.035, 0.03, 0.026);                      // what all the walls send back
const Vec3 kLamp(-1.75, 1.7, 2.2);
constexpr double kLampRadius = 0.11;
const Rgb kLampRadiance(260, 170, 80);

struct Ball {
  Vec3 centre;
  double radius;
  Rgb albedo;  ///< of a mirror, its reflectance
  bool mirror;
};
const std::array<Ball, 3> kBalls = {{{{0, 1.2, 0.5}, 0.55, {0.92, 0.92, 0.94}, true},
                                     {{-1.35, 0.35, 1.2}, 0.35, {0.75, 0.13, 0.08}, false},
                                     {{1.15, 0.22, 1.5}, 0.22, {0.85, 0.85, 0.82}, false}}};

struct Hit {
  double distance;
  Vec3 normal;
  Rgb albedo;
  bool mirror = false;
};

std::optional<double> distance_to_sphere(const Vec3& origin, const Vec3& dir, const Vec3& centre, double radius) {
  const Vec3 from = origin - centre;
  const double b = from.dot(dir), discriminant = b * b - from.squaredNorm() + radius * radius;
  if (discriminant < 0) return std::nullopt;
  const double near = -b - std::sqrt(discriminant);
  if (near > 1e-6) return near;
  return std::nullopt;
}

bool in_window(double x, double y) {
  if (x < kWindowLeft || x > kWindowRight || y < kSill || y > kLintel) return false;
  const double bar = 0.035;  // of the frame
  return std::abs(x - 0.5 * (kWindowLeft + kWindowRight)) > bar && std::abs(y - 1.45) > bar;
}

Rgb sky(const Vec3& dir) {
  if (dir.dot(kToSun) > kSunCosine) return kSun;
  const double glow = std::pow(std::max(0.0, dir.dot(kToSun)), 60);
  if (dir.y() < 0.03 + 0.02 * std::sin(9 * dir.x() / dir.z()) + 0.012 * std::sin(23 * dir.x() / dir.z())) {
    return Rgb(2.6, 3.4, 1.5) + glow * Rgb(5, 4, 2);  // hills
  }
  const double up = std::clamp(dir.y() / 0.5, 0.0, 1.0);
  return (1 - up) * Rgb(26, 24, 22) + up * Rgb(9, 15, 26) + glow * Rgb(120, 95, 60);
}

/// The same without edges, for the light that comes through the window: it is summed from few directions.
Rgb soft_sky(const Vec3& dir) {
  const double above = std::clamp((dir.y() + 0.25) / 0.5, 0.0, 1.0), up = std::clamp(dir.y() / 0.5, 0.0, 1.0);
  const double t = above * above * (3 - 2 * above);
  return (1 - t) * Rgb(2.6, 3.0, 1.9) + t * ((1 - up) * Rgb(26, 24, 22) + up * Rgb(9, 15, 26));
}

Rgb wall_albedo(const Vec3& p, int axis) {
  if (axis == 1 && p.y() < 0.01) {  // boards, every third of another tree
    const int board = static_cast<int>(std::floor(p.x() / 0.18 + 100));
    const double along = p.z() + 0.37 * (board % 5);
    const double seam =
        std::min(std::abs(p.x() / 0.18 - std::round(p.x() / 0.18)), std::abs(along / 1.1 - std::round(along / 1.1)));
    const double tone = 0.75 + 0.12 * (board % 3) + 0.06 * std::sin(40 * p.x() + 3 * std::sin(5 * along));
    return tone * (seam < 0.02 ? 0.35 : 1.0) * Rgb(0.42, 0.27, 0.16);
  }
  if (axis == 1) return {0.82, 0.81, 0.78};
  if (axis == 0) return p.x() < 0 ? Rgb(0.30, 0.42, 0.46) : Rgb(0.66, 0.60, 0.50);
  // A bookcase of dark colours on the window's wall, a picture behind the camera.
  if (p.z() > 0 && p.x() < -0.3 && p.x() > -1.3 && p.y() < 1.9) {
    const double shelf = std::fmod(p.y(), 0.38);
    if (shelf < 0.035) return {0.20, 0.13, 0.08};
    const int book = static_cast<int>(std::floor((p.x() + 2) / 0.055)) * 7 + static_cast<int>(p.y() / 0.38) * 13;
    if (shelf > 0.24 + 0.08 * std::sin(book)) return {0.02, 0.016, 0.012};
    return Rgb(0.16 + 0.14 * std::sin(book), 0.12 + 0.1 * std::sin(1.7 * book), 0.12 + 0.11 * std::sin(2.3 * book))
        .max(0.015);
  }
  if (p.z() < 0 && std::abs(p.x()) < 0.9 && p.y() > 1 && p.y() < 2) return {0.5, 0.35 + 0.2 * std::sin(8 * p.x()), 0.2};
  return {0.72, 0.70, 0.66};
}

/// nullopt: through the window.
std::optional<Hit> nearest(const Vec3& origin, const Vec3& dir) {
  Hit hit{HUGE_VAL, Vec3::Zero(), Rgb::Zero(), false};
  int wall = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (dir[axis] == 0) continue;
    const double to = ((dir[axis] > 0 ? kRoomMax : kRoomMin)[axis] - origin[axis]) / dir[axis];
    if (to < hit.distance) {
      hit.distance = to;
      wall = axis;
    }
  }
  hit.normal[wall] = dir[wall] > 0 ? -1 : 1;
  bool room = true;
  for (const Ball& ball : kBalls) {
    const auto to = distance_to_sphere(origin, dir, ball.centre, ball.radius);
    if (!to || *to >= hit.distance) continue;
    hit = {*to, (origin + *to * dir - ball.centre) / ball.radius, ball.albedo, ball.mirror};
    room = false;
  }
  if (!room) return hit;
  const Vec3 p = origin + hit.distance * dir;
  if (wall == 2 && dir.z() > 0 && in_window(p.x(), p.y())) return std::nullopt;
  hit.albedo = wall_albedo(p, wall);
  return hit;
}

bool blocked(const Vec3& origin, const Vec3& dir, double distance) {
  return std::any_of(kBalls.begin(), kBalls.end(), [&](const Ball& ball) {
    const auto to = distance_to_sphere(origin, dir, ball.centre, ball.radius);
    return to && *to < distance;
  });
}

/// From the sun and the sky through the window, from the lamp, and from the walls together.
Rgb irradiance(const Vec3& p, const Vec3& n) {
  Rgb sum = kPi * kBounce * (0.75 + 0.25 * n.y());
  const double to_wall = (kRoomMax.z() - p.z()) / kToSun.z();
  const Vec3 at_window = p + to_wall * kToSun;
  if (n.dot(kToSun) > 0 && to_wall > 0 && in_window(at_window.x(), at_window.y()) && !blocked(p, kToSun, to_wall)) {
    sum += n.dot(kToSun) * kSunlight;
  }
  constexpr int kAcross = 3, kUp = 4;
  const double area = (kWindowRight - kWindowLeft) * (kLintel - kSill) / (kAcross * kUp);
  for (int k = 0; k < kAcross * kUp; ++k) {
    const Vec3 on_window(kWindowLeft + (kWindowRight - kWindowLeft) * (k % kAcross + 0.5) / kAcross,
                         kSill + (kLintel - kSill) * (k / kAcross + 0.5) / kUp, kRoomMax.z());
    const Vec3 to = on_window - p;
    const double squared = std::max(to.squaredNorm(), 0.05);
    const Vec3 dir = to / std::sqrt(squared);
    const double form = std::max(0.0, n.dot(dir)) * std::max(0.0, dir.z()) * area / squared;
    if (form <= 0 || blocked(p, dir, std::sqrt(squared))) continue;
    sum += form * soft_sky(dir);
  }
  const Vec3 to_lamp = kLamp - p;
  const double lamp_distance = to_lamp.norm();
  const Vec3 lamp_dir = to_lamp / lamp_distance;
  if (n.dot(lamp_dir) > 0 && lamp_distance > kLampRadius && !blocked(p, lamp_dir, lamp_distance)) {
    const double sine = kLampRadius / lamp_distance;
    sum += kPi * sine * sine * n.dot(lamp_dir) * kLampRadiance;
  }
  return sum;
}

Rgb radiance(const Vec3& origin, const Vec3& dir, int mirrors) {
  const std::optional<Hit> hit = nearest(origin, dir);
  const auto lamp = distance_to_sphere(origin, dir, kLamp, kLampRadius);
  if (lamp && (!hit || *lamp < hit->distance)) return kLampRadiance;
  if (!hit) return sky(dir);
  const Vec3 p = origin + hit->distance * dir + 1e-6 * hit->normal;
  if (hit->mirror) {
    if (mirrors == 0) return Rgb::Zero();
    return hit->albedo * radiance(p, dir - 2 * dir.dot(hit->normal) * hit->normal, mirrors - 1);
  }
  return hit->albedo / kPi * irradiance(p, hit->normal);
}

}  // namespace

Image<float> built_in_scene(Size size) {
  HDR_ASSERT(size.width >= 16 && size.height >= 16);
  Image<float> scene(size, 3);
  constexpr int kRays = 2;  // a side
  const double pixel = 2 * std::tan(35 * kDegree) / size.width;
  for_rows(size.height, 8, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        Rgb sum = Rgb::Zero();
        for (int k = 0; k < kRays * kRays; ++k) {
          const double px = x + (k % kRays + 0.5) / kRays - 0.5 * size.width;
          const double py = y + (k / kRays + 0.5) / kRays - 0.5 * size.height;
          sum += radiance(kEye, Vec3(pixel * px, -pixel * py, 1).normalized(), 1);
        }
        for (int c = 0; c < 3; ++c) scene(x, y, c) = static_cast<float>(sum[c] / (kRays * kRays));
      }
    }
  });
  return scene;
}

}  // namespace hdr
