#include "libhdr/light/internal/solid_angle.h"

#include <algorithm>
#include <cmath>

#include "libhdr/core/sphere.h"

namespace hdr {
namespace {

// A projection that is symmetric about its axis shows polar angle theta at radius r (of the disc's): a ring dr holds
// 2 pi sin(theta) theta' dr steradians on 2 pi r R^2 dr square pixels.
double ring_density(double sin_theta_over_r, double theta_slope, double disc_radius) {
  return sin_theta_over_r * theta_slope / (disc_radius * disc_radius);
}

struct DensityAt {
  Vec2 px;

  double operator()(const LatLong& map) const {
    const double polar = kPi * std::clamp(px.y() / map.size.height, 0.0, 1.0);
    return 2 * kPi / map.size.width * kPi / map.size.height * std::sin(polar);
  }

  double operator()(const AngularMap& map) const {
    const double r = std::hypot(px.x() - map.disc.cx, px.y() - map.disc.cy) / map.disc.r;
    const double theta = kPi * r;
    return ring_density(theta > 1e-8 ? std::sin(theta) / r : kPi, kPi, map.disc.r);
  }

  // A ray that leaves the camera at angle a from the axis meets the ball at incidence i, sin i = D sin a, where the
  // normal is i - a from the axis; it is thrown to theta = 2 i - a. The disc's rim is the tangent ray, sin a = 1 / D.
  // A far camera has theta = 2 asin(r): each square pixel shows the same solid angle.
  double operator()(const MirrorBall& ball) const {
    if (std::isinf(ball.distance)) return 4 / (ball.disc.r * ball.disc.r);
    const double r = std::min(std::hypot(px.x() - ball.disc.cx, px.y() - ball.disc.cy) / ball.disc.r, 1 - 1e-15);
    const double tangent = 1 / std::sqrt(ball.distance * ball.distance - 1);
    const double a = std::atan(tangent * r);
    const double i = std::asin(std::min(1.0, ball.distance * std::sin(a)));
    const double a_slope = tangent / (1 + tangent * tangent * r * r);
    const double i_slope = ball.distance * std::cos(a) / std::max(std::cos(i), 1e-15) * a_slope;
    const double theta = 2 * i - a, theta_slope = 2 * i_slope - a_slope;
    return ring_density(r > 1e-8 ? std::sin(theta) / r : theta_slope, theta_slope, ball.disc.r);
  }

  // A square pixel at distance rho from the pinhole, seen under the cosine f / rho.
  double operator()(const Rectilinear& view) const {
    if (view.distortion != BrownConrady{}) return numeric(view);
    const double f = view.focal_px();
    const double rho = std::hypot(f, px.x() - 0.5 * view.size.width, px.y() - 0.5 * view.size.height);
    return f / (rho * rho * rho);
  }

  template <class Other>
  double operator()(const Other& projection) const {
    return numeric(projection);
  }

  /// |d dir / dx  x  d dir / dy| by differences, to the one side where the other has left the picture.
  template <class Any>
  double numeric(const Any& projection) const {
    constexpr double kStep = 1e-4;
    const auto slope = [&](const Vec2& step) -> Vec3 {
      const auto before = projection.dir_from_px(px - step), here = projection.dir_from_px(px);
      const auto after = projection.dir_from_px(px + step);
      if (before && after) return (*after - *before) / (2 * kStep);
      if (here && after) return (*after - *here) / kStep;
      if (here && before) return (*here - *before) / kStep;
      return Vec3::Zero();
    };
    return slope({kStep, 0}).cross(slope({0, kStep})).norm();
  }
};

/// Where the picture shows the middle of its view.
Vec2 middle_of(const Projection& projection) {
  if (const std::optional<Disc> disc = disc_of(projection)) return {disc->cx, disc->cy};
  const auto front = px_from_dir(projection, Vec3::UnitZ());  // the middle of a face or a lat-long, too
  return front.value_or(Vec2::Zero());
}

}  // namespace

double solid_angle_density(const Projection& projection, const Vec2& px) {
  return std::visit(DensityAt{px}, projection);
}

double solid_angle_in_middle(const Projection& projection) {
  return solid_angle_density(projection, middle_of(projection));
}

}  // namespace hdr
