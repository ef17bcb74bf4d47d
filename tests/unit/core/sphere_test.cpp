#include "libhdr/core/sphere.h"

#include <gtest/gtest.h>

#include "libhdr/core/random.h"

namespace hdr {
namespace {

TEST(Sphere, LatLongAxesAreThoseOfTheConvention) {
  EXPECT_TRUE(dir_from_latlong(0.5, 0.5).isApprox(Vec3(0, 0, 1), 1e-12)) << "the centre looks along +Z";
  EXPECT_TRUE(dir_from_latlong(0.25, 0.5).isApprox(Vec3(1, 0, 0), 1e-12)) << "+X is LEFT of the centre";
  EXPECT_TRUE(dir_from_latlong(0.75, 0.5).isApprox(Vec3(-1, 0, 0), 1e-12));
  EXPECT_TRUE(dir_from_latlong(0.5, 0.0).isApprox(Vec3(0, 1, 0), 1e-12)) << "the top row looks up";
}

TEST(Sphere, LatLongRoundTrip) {
  Random random(1, 2);
  for (int k = 0; k < 10000; ++k) {
    const double u = random.uniform(), v = random.uniform();
    const Vec2 back = latlong_from_dir(dir_from_latlong(u, v));
    EXPECT_NEAR(back.x(), u, 1e-12) << "at v = " << v;
    EXPECT_NEAR(back.y(), v, 1e-12);
  }
  EXPECT_EQ(latlong_from_dir({0, 1, 0}).y(), 0);
  EXPECT_EQ(latlong_from_dir({0, -1, 0}).y(), 1);
}

TEST(Sphere, SolidAnglesOfAMapSumTo4Pi) {
  for (const int height : {1, 2, 7, 512, 8192}) {
    double sum = 0;
    for (int y = 0; y < height; ++y) sum += 2 * height * latlong_pixel_solid_angle(y, 2 * height, height);
    EXPECT_NEAR(sum, 4 * kPi, 1e-11) << "height " << height;
  }
  // A pinned value: the polar cap of a 1024 x 512 map, 2 pi (1 - cos(pi/512)) / 1024.
  EXPECT_NEAR(latlong_pixel_solid_angle(0, 1024, 512) / 1.15505e-7, 1, 1e-4);
}

TEST(Sphere, RotationIsRzRyRx) {
  const Mat3 r = rotation_from_degrees({90, 0, 90});
  EXPECT_TRUE((r * Vec3(0, 1, 0)).isApprox(Vec3(0, 0, 1), 1e-12)) << "Rx turns +Y to +Z, which Rz leaves";
  EXPECT_TRUE((rotation_from_degrees({0, 90, 0}) * Vec3(0, 0, 1)).isApprox(Vec3(1, 0, 0), 1e-12));
}

TEST(Sphere, TangentsAreOrthonormalAndRightHanded) {
  Random random(3, 4);
  for (int k = 0; k < 1000; ++k) {
    Vec3f n(float(random.normal()), float(random.normal()), float(random.normal()));
    n.normalize();
    if (k == 0) n = {0, 0, -1};
    Vec3f t, b;
    tangents_from_normal(n, t, b);
    EXPECT_NEAR(t.dot(n), 0, 1e-6f);
    EXPECT_NEAR((t.cross(b) - n).norm(), 0, 1e-6f) << "normal " << n.transpose();
  }
}

}  // namespace
}  // namespace hdr
