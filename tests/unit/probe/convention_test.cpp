// Which way round others have the sphere: against OpenEXR itself, and against the formulas of the others' sources,
// written down here in their own variables.
#include "libhdr/probe/convention.h"

#include <ImfEnvmap.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/probe/projection.h"
#include "libhdr/probe/test_chart.h"
#include "libhdr/probe/unwrap.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

constexpr int kDirections = 2000;

/// Compares a lat-long of a convention with u, v in [0,1], v down, of a direction in our axes.
template <class UvFromDir>
void expect_uv(Convention convention, const UvFromDir& uv_from_dir) {
  const LatLong map{{400, 200}, convention};
  Random random(17, 1);
  for (int k = 0; k < kDirections; ++k) {
    const Vec3 dir = test::random_direction(random);
    const Vec2 px = *map.px_from_dir(dir), uv = uv_from_dir(dir);
    const double u = uv.x() - std::floor(uv.x());
    EXPECT_LT(std::abs(std::remainder(px.x() - 400 * u, 400.0)), 1e-3)
        << name_of(convention) << ": " << dir.transpose();
    EXPECT_NEAR(px.y(), 200 * uv.y(), 1e-3) << name_of(convention) << ": " << dir.transpose();
  }
}

TEST(Convention, OpenExrLatLongs) {
  constexpr int kWidth = 401, kHeight = 201;
  const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(kWidth - 1, kHeight - 1));
  expect_uv(Convention::kOpenExr, [&](const Vec3& d) {
    const Imath::V2f p = Imf::LatLongMap::pixelPosition(window, Imath::V3f(float(d.x()), float(d.y()), float(d.z())));
    return Vec2(p.x / (kWidth - 1.0), p.y / (kHeight - 1.0));  // corner pixels lie on the pole and the seam
  });
}

TEST(Convention, OpenExrCubes) {
  constexpr int kFace = 101;
  const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(kFace - 1, 6 * kFace - 1));
  const Cube cube{Cube::Layout::kVerticalStrip, 1000};
  Random random(17, 2);
  for (int k = 0; k < kDirections; ++k) {
    const Vec3 d = test::random_direction(random);
    Imf::CubeMapFace face;
    Imath::V2f in_face;
    Imf::CubeMap::faceAndPixelPosition(Imath::V3f(float(d.x()), float(d.y()), float(d.z())), window, face, in_face);
    const Imath::V2f p = Imf::CubeMap::pixelPosition(face, window, in_face);
    const double number = static_cast<int>(face);
    const Vec2 theirs(p.x / (kFace - 1.0) * 1000, (number + (p.y - number * kFace) / (kFace - 1.0)) * 1000);
    EXPECT_LT((*cube.px_from_dir(d) - theirs).norm(), 0.01) << d.transpose();
  }
}

// The OpenGL 4.6 specification, table 8.19: major axis, sc, tc, ma; s = (sc / |ma| + 1) / 2.
Vec2 opengl_strip(const Vec3& r, double n) {
  const Vec3 a = r.cwiseAbs();
  const int axis = a.x() >= a.y() && a.x() >= a.z() ? 0 : a.y() >= a.z() ? 1 : 2;
  const bool positive = r[axis] >= 0;
  const double sc[3] = {positive ? -r.z() : r.z(), r.x(), positive ? r.x() : -r.x()};
  const double tc[3] = {-r.y(), positive ? r.z() : -r.z(), -r.y()};
  return {(sc[axis] / a[axis] + 1) / 2 * n, (2 * axis + (positive ? 0 : 1) + (tc[axis] / a[axis] + 1) / 2) * n};
}

TEST(Convention, OpenGlCubesAndThreeJs) {
  const Cube gl{Cube::Layout::kVerticalStrip, 64, Convention::kOpenGl};
  const Cube three{Cube::Layout::kVerticalStrip, 64, Convention::kThreeJs};
  Random random(17, 3);
  for (int k = 0; k < kDirections; ++k) {
    const Vec3 d = test::random_direction(random);
    EXPECT_LT((*gl.px_from_dir(d) - opengl_strip(d, 64)).norm(), 1e-9) << d.transpose();
    EXPECT_LT((*three.px_from_dir(d) - opengl_strip({-d.x(), d.y(), d.z()}, 64)).norm(), 1e-9) << d.transpose();
  }
}

TEST(Convention, LatLongsOfOthers) {
  expect_uv(Convention::kBlender, [](const Vec3& d) {
    const Vec3 b(d.x(), -d.z(), d.y());  // Blender's axes
    return Vec2(0.5 - std::atan2(b.y(), b.x()) / (2 * kPi), std::acos(b.z()) / kPi);
  });
  expect_uv(Convention::kThreeJs, [](const Vec3& d) {
    return Vec2(std::atan2(d.z(), d.x()) / (2 * kPi) + 0.5, 1 - (std::asin(d.y()) / kPi + 0.5));  // v is up
  });
  expect_uv(Convention::kPbrt, [](const Vec3& d) {
    const Vec3 p(d.x(), d.z(), d.y());  // pbrt's axes
    return Vec2(std::atan2(p.y(), p.x()) / (2 * kPi), std::acos(p.z()) / kPi);
  });
  expect_uv(Convention::kAliceVision, [](const Vec3& d) {
    const Vec3 a(-d.x(), -d.y(), d.z());  // AliceVision's axes
    return Vec2((std::atan2(a.x(), a.z()) + kPi) / (2 * kPi), (std::asin(a.y()) + 0.5 * kPi) / kPi);
  });
  expect_uv(Convention::kHdrToolbox, [](const Vec3& d) {
    return Vec2((std::atan2(d.z(), d.x()) + 0.5 * kPi + kPi) / (2 * kPi), std::acos(d.y()) / kPi);
  });
  // Mitsuba 3: u = atan2(x, -z) / 2 pi, which is OpenEXR's.
  expect_uv(convention_from_name("mitsuba").value(),
            [](const Vec3& d) { return Vec2(std::atan2(d.x(), -d.z()) / (2 * kPi), std::acos(d.y()) / kPi); });
}

TEST(Convention, NamesRoundTrip) {
  for (const char* name : {"openexr", "blender", "threejs", "pbrt", "alicevision", "hdrtoolbox", "opengl"}) {
    EXPECT_STREQ(name_of(convention_from_name(name).value()), name);
  }
  EXPECT_FALSE(convention_from_name("maya"));
}

// A cross is one piece of paper: where two of its faces touch, the sphere goes on.
TEST(Convention, FacesOfACrossMeet) {
  for (const Convention convention : {Convention::kOpenExr, Convention::kOpenGl, Convention::kThreeJs}) {
    for (const auto layout : {Cube::Layout::kHorizontalCross, Cube::Layout::kVerticalCross}) {
      const Cube cube{layout, 10, convention};
      int meetings = 0;
      for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) {
          for (const Vec2& out : {Vec2(10, 0), Vec2(0, 10)}) {
            const Vec2 middle(10 * column + 5, 10 * row + 5);
            if (!cube.dir_from_px(middle) || !cube.dir_from_px(middle + out)) continue;
            ++meetings;
            const Vec2 aside(0.3 * out.y(), 0.3 * out.x());
            const Vec3 here = *cube.dir_from_px(middle + 0.499 * out + aside);
            const Vec3 there = *cube.dir_from_px(middle + 0.501 * out + aside);
            EXPECT_LT((here - there).norm(), 0.01) << "row " << row << ", column " << column;
          }
        }
      }
      EXPECT_EQ(meetings, 5);
    }
  }
}

TEST(TestChart, ColoursSayTheDirectionInEveryConvention) {
  const Image<float> chart = test_chart(1024);
  // Away from lines and labels: 37.5 degrees up, 52.5 degrees from +Z towards +X.
  const double up = 37.5 * kDegree, around = 52.5 * kDegree;
  const Vec3 dir(std::cos(up) * std::sin(around), std::sin(up), std::cos(up) * std::cos(around));
  for (const char* name : {"openexr", "blender", "threejs", "pbrt", "alicevision", "hdrtoolbox"}) {
    const LatLong to{{512, 256}, convention_from_name(name).value()};
    const Image<float> turned = resample(chart, LatLong{chart.size()}, to, to.size);
    const Vec2 px = *to.px_from_dir(dir);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(turned(int(px.x()), int(px.y()), c), 0.5 + 0.5 * dir[c], 0.01) << name << ", channel " << c;
    }
  }
}

}  // namespace
}  // namespace hdr
