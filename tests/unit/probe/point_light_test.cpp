// Where an unwrapped light is. What a ball's picture says of a light narrower than a pixel is which pixel it is in; of
// a wider one the picture knows the middle far better, and the map must keep it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/unwrap.h"

namespace hdr {
namespace {

double degrees_between(const Vec3& a, const Vec3& b) {
  return 2 / kDegree * std::asin(std::min(1.0, 0.5 * (a.normalized() - b).norm()));
}

/// A Gaussian light in the dark on a ball, each pixel the mean over its square.
Image<float> picture_of(const MirrorBall& ball, Size size, const Vec3& light, double deviation_degrees) {
  constexpr int kAxis = 16;
  const double s = deviation_degrees * kDegree, reach = 6 * s;
  const Vec2 at = *ball.px_from_dir(light);
  Image<float> picture(size, 3);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Vec2 px(x + 0.5, y + 0.5);
      const auto middle = ball.dir_from_px(px);
      const bool lit = (px - at).norm() < 2 || (middle && (*middle - light).norm() < reach);
      if (!lit) continue;
      double sum = 0;
      for (int k = 0; k < kAxis * kAxis; ++k) {
        const auto d = ball.dir_from_px({x + (k % kAxis + 0.5) / kAxis, y + (k / kAxis + 0.5) / kAxis});
        if (d) sum += std::exp(-0.5 * (*d - light).squaredNorm() / (s * s));
      }
      std::fill_n(picture.pixel(x, y), 3, static_cast<float>(1000 * sum / (kAxis * kAxis)));
    }
  }
  return picture;
}

/// The mean direction of all light.
Vec3 centroid(const Image<float>& latlong) {
  Vec3 sum = Vec3::Zero();
  for (int y = 0; y < latlong.height(); ++y) {
    const double area = std::cos(kPi * y / latlong.height()) - std::cos(kPi * (y + 1) / latlong.height());
    for (int x = 0; x < latlong.width(); ++x) {
      const double light = static_cast<double>(latlong(x, y, 1));
      sum += area * light * dir_from_latlong((x + 0.5) / latlong.width(), (y + 0.5) / latlong.height());
    }
  }
  return sum;
}

struct Light {
  MirrorBall ball;
  double radius;  ///< of the ball's, where it is
  Vec3 dir;
  double half_pixel;  ///< degrees that half a pixel towards the middle is
};

Light random_light(std::uint64_t seed, double ball_radius, double farthest) {
  Random random(seed, 6);
  constexpr double kDistances[] = {5, 30, std::numeric_limits<double>::infinity()};
  Light light{
      {{1.1 * ball_radius + random.uniform(), 1.1 * ball_radius + random.uniform(), ball_radius}, kDistances[seed % 3]},
      farthest * std::sqrt(random.uniform()),
      {},
      0};
  const double azimuth = 2 * kPi * random.uniform();
  const Vec2 out(std::cos(azimuth), std::sin(azimuth)), middle(light.ball.disc.cx, light.ball.disc.cy);
  const Vec2 px = middle + light.radius * ball_radius * out;
  light.dir = *light.ball.dir_from_px(px);
  light.half_pixel = degrees_between(*light.ball.dir_from_px(px - 0.5 * out), light.dir);
  return light;
}

double error_of(const Light& light, double deviation_degrees) {
  const int side = static_cast<int>(2.2 * light.ball.disc.r) + 2;
  const Image<float> picture = picture_of(light.ball, {side, side}, light.dir, deviation_degrees);
  const Size size{1024, 512};
  return degrees_between(centroid(resample(picture, light.ball, LatLong{size}, size)), light.dir);
}

TEST(PointLight, WiderThanAPixelItIsWhereItWas) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Light light = random_light(seed, 250, 0.95);
    EXPECT_LT(error_of(light, std::max(0.5, light.half_pixel)), 0.05)
        << "seed " << seed << ", at " << light.radius << " of the radius, distance " << light.ball.distance;
  }
}

/// Two lights in one pixel that light no other give the same picture: nothing can tell them apart.
TEST(PointLight, NarrowerThanAPixelItsPixelIsAllThatIsKnown) {
  double most = 0;
  for (std::uint64_t seed = 21; seed <= 32; ++seed) {
    const Light light = random_light(seed, 100, 0.8);
    const double error = error_of(light, 0.05);
    EXPECT_LT(error, 1.5 * light.half_pixel) << "half a pixel each way, seed " << seed;
    most = std::max(most, error / light.half_pixel);
  }
  EXPECT_GT(most, 0.3) << "and no less than that: a picture that knew better would have to be finer";
}

}  // namespace
}  // namespace hdr
