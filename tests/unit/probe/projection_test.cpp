#include "libhdr/probe/projection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

// One set of laws for every projection. A case: a projection with what its picture shows of the sphere.
struct LatLongCase {
  static LatLong projection() { return {{200, 100}}; }
  static constexpr double kCovered = 4 * kPi;
};
struct AngularMapCase {
  static AngularMap projection() { return {{101.5, 99, 90}}; }
  static constexpr double kCovered = 4 * kPi;
};
template <int kDistance>  // 0 is far
struct MirrorBallCase {
  static MirrorBall projection() { return {{120.25, 99.5, 92}, kDistance == 0 ? kFar : kDistance}; }
  // All but a cone of half-angle asin(1/D): 2 pi (1 + cos).
  static inline const double kCovered =
      kDistance == 0 ? 4 * kPi : 2 * kPi * (1 + std::sqrt(1 - 1.0 / std::max(1, kDistance* kDistance)));
};
struct RectilinearCase {
  static Rectilinear projection() { return {{180, 120}, 75}; }
  // A pyramid of half-widths a, b at distance 1: 4 asin(sin atan a sin atan b).
  static inline const double kA = std::tan(37.5 * kDegree), kB = kA * 120 / 180;
  static inline const double kCovered = 4 * std::asin(std::sin(std::atan(kA)) * std::sin(std::atan(kB)));
};

template <int kFov, int kVfov, int kAzimuth, int kElevation>
struct PanoramaCase {
  static Panorama projection() { return {{210, 90}, kFov, kVfov, kAzimuth, kElevation}; }
  static inline const double kCovered =
      kFov * kDegree *
      (std::sin((kElevation + 0.5 * kVfov) * kDegree) - std::sin((kElevation - 0.5 * kVfov) * kDegree));
};
template <Convention kConvention>
struct TurnedLatLongCase {
  static LatLong projection() { return {{200, 100}, kConvention}; }
  static constexpr double kCovered = 4 * kPi;
};
/// A barrel lens; what its frame holds, by quadrature over the plane at distance 1 of d omega = (1 + r^2)^-3/2 dA.
struct DistortedCase {
  static Rectilinear projection() { return {{180, 120}, 60, {-0.15, 0.03, 0.002, -0.001, 0.004}}; }
  static double covered() {
    constexpr double kStep = 1e-3;
    const double half_width = std::tan(30 * kDegree), half_height = half_width * 120 / 180;
    double total = 0;
    for (double y = -0.6 + 0.5 * kStep; y < 0.6; y += kStep) {
      for (double x = -0.9 + 0.5 * kStep; x < 0.9; x += kStep) {
        const double r2 = x * x + y * y, radial = 1 - 0.15 * r2 + 0.03 * r2 * r2 + 0.004 * r2 * r2 * r2;
        const double u = x * radial + 2 * 0.002 * x * y - 0.001 * (r2 + 2 * x * x);
        const double v = y * radial + 0.002 * (r2 + 2 * y * y) - 2 * 0.001 * x * y;
        if (std::abs(u) <= half_width && std::abs(v) <= half_height) total += kStep * kStep * std::pow(1 + r2, -1.5);
      }
    }
    return total;
  }
  static inline const double kCovered = covered();
};
template <Lens kLens, int kFov>
struct FisheyeCase {
  static Fisheye projection() { return {{101.5, 99, 90}, kFov, kLens, {-0.04, 0.006, -0.002, 0.0004}}; }
  static inline const double kCovered = 2 * kPi * (1 - std::cos(0.5 * kFov * kDegree));
};
template <Cube::Layout kLayout, Convention kConvention>
struct CubeCase {
  static Cube projection() { return {kLayout, 30, kConvention}; }
  static constexpr double kCovered = 4 * kPi;
};
template <bool kEqualArea>
struct OctahedralCase {
  static Octahedral projection() { return {{150, 150}, kEqualArea}; }
  static constexpr double kCovered = 4 * kPi;
};
struct HemisphereCase {
  static Hemisphere projection() { return {{101.5, 99, 90}}; }
  static constexpr double kCovered = 2 * kPi;
};
struct DualParaboloidCase {
  static DualParaboloid projection() { return {{240, 120}}; }
  static constexpr double kCovered = 4 * kPi;
};

template <class Case>
class EveryProjection : public testing::Test {};
using Cases = testing::Types<
    LatLongCase, AngularMapCase, MirrorBallCase<0>, MirrorBallCase<20>, MirrorBallCase<5>, MirrorBallCase<2>,
    RectilinearCase, DistortedCase, TurnedLatLongCase<Convention::kBlender>, TurnedLatLongCase<Convention::kPbrt>,
    TurnedLatLongCase<Convention::kHdrToolbox>, FisheyeCase<Lens::kEquidistant, 360>,
    FisheyeCase<Lens::kEquidistant, 190>, FisheyeCase<Lens::kEquisolid, 360>, FisheyeCase<Lens::kEquisolid, 200>,
    FisheyeCase<Lens::kStereographic, 220>, FisheyeCase<Lens::kOrthographic, 170>, FisheyeCase<Lens::kPolynomial, 190>,
    FisheyeCase<Lens::kKannalaBrandt, 190>, CubeCase<Cube::Layout::kHorizontalCross, Convention::kOpenExr>,
    CubeCase<Cube::Layout::kVerticalCross, Convention::kOpenExr>,
    CubeCase<Cube::Layout::kHorizontalCross, Convention::kOpenGl>,
    CubeCase<Cube::Layout::kVerticalStrip, Convention::kOpenExr>,
    CubeCase<Cube::Layout::kHorizontalStrip, Convention::kOpenGl>, CubeCase<Cube::Layout::kFaces, Convention::kThreeJs>,
    OctahedralCase<false>, OctahedralCase<true>, HemisphereCase, DualParaboloidCase, PanoramaCase<360, 120, 30, 10>,
    PanoramaCase<180, 90, -150, 0>, PanoramaCase<40, 30, 90, -75>>;
TYPED_TEST_SUITE(EveryProjection, Cases);

TYPED_TEST(EveryProjection, PixelsRoundTripThroughUnitDirections) {
  const auto projection = TypeParam::projection();
  int shown = 0;
  for (double y = 0.37; y < 200; y += 1.93) {
    for (double x = 0.41; x < 240; x += 1.87) {
      const Vec2 px(x, y);
      const auto dir = projection.dir_from_px(px);
      if (!dir) continue;
      ++shown;
      EXPECT_NEAR(dir->norm(), 1, 1e-12) << "at pixel " << px.transpose();
      const auto back = projection.px_from_dir(*dir);
      ASSERT_TRUE(back) << "pixel " << px.transpose() << " shows " << dir->transpose() << " but nothing shows that";
      EXPECT_LT((*back - px).norm(), 1e-8)
          << "pixel " << px.transpose() << " -> " << dir->transpose() << " -> " << back->transpose();
    }
  }
  EXPECT_GT(shown, 1200);
}

TYPED_TEST(EveryProjection, DirectionsRoundTripAndCoverTheirShareOfTheSphere) {
  const auto projection = TypeParam::projection();
  Random random(3, 1);
  constexpr int kCount = 40000;
  int shown = 0;
  for (int k = 0; k < kCount; ++k) {
    const Vec3 dir = test::random_direction(random);
    const auto px = projection.px_from_dir(dir);
    if (!px) continue;
    ++shown;
    const auto back = projection.dir_from_px(*px);
    ASSERT_TRUE(back) << dir.transpose() << " is shown at " << px->transpose() << ", a pixel that shows nothing";
    EXPECT_LT((*back - dir).norm(), 1e-7)
        << dir.transpose() << " -> " << px->transpose() << " -> " << back->transpose();
  }
  // The share of uniform directions that is seen is the covered solid angle over 4 pi, within 4 sigma.
  const double share = TypeParam::kCovered / (4 * kPi);
  EXPECT_NEAR(shown / double(kCount), share, 4 * std::sqrt(share * (1 - share) / kCount) + 1e-9);
}

TYPED_TEST(EveryProjection, SolidAnglesAddUpToWhatIsCovered) {
  const auto projection = TypeParam::projection();
  // |d dir/dx x d dir/dy| summed over a fine grid of pixel cells; a rim's last cells are missed.
  constexpr double kStep = 0.25, kInside = 1e-6;  // a cell's corners lie in the cell, not on a face's edge
  double total = 0;
  for (double y = 0; y < 200; y += kStep) {
    for (double x = 0; x < 240; x += kStep) {
      const double x0 = x + kInside, y0 = y + kInside, x1 = x + kStep - kInside, y1 = y + kStep - kInside;
      const auto a = projection.dir_from_px({x0, y0}), b = projection.dir_from_px({x1, y0});
      const auto c = projection.dir_from_px({x0, y1}), d = projection.dir_from_px({x1, y1});
      if (!a || !b || !c || !d) continue;
      const Vec3 diagonal1 = *d - *a, diagonal2 = *c - *b;
      total += 0.5 * diagonal1.cross(diagonal2).norm();
    }
  }
  EXPECT_NEAR(total / TypeParam::kCovered, 1, 0.04);
  EXPECT_LT(total, TypeParam::kCovered * 1.0005);
}

void expect_shows(const Projection& projection, const Vec2& px, const Vec3& dir) {
  const auto shown = dir_from_px(projection, px);
  ASSERT_TRUE(shown) << text_from_projection(projection) << " shows nothing at " << px.transpose();
  EXPECT_LT((*shown - dir).norm(), 1e-9) << text_from_projection(projection) << " at " << px.transpose() << " shows "
                                         << shown->transpose() << ", not " << dir.transpose();
}

// Round trips cannot see a mistake that both halves share: these numbers are the conventions of core/sphere.h.
TEST(Projection, LatLongIsPinned) {
  const LatLong map{{400, 200}};
  expect_shows(map, {200, 100}, {0, 0, 1});
  expect_shows(map, {100, 100}, {1, 0, 0});  // +X is to the left of the centre
  expect_shows(map, {300, 100}, {-1, 0, 0});
  expect_shows(map, {123, 0}, {0, 1, 0});
  expect_shows(map, {0, 100}, {0, 0, -1});
}

TEST(Projection, PanoramasArePinned) {
  // A quarter of a turn wide, its middle 90 degrees to the right and 20 up.
  const Panorama part{{180, 120}, 90, 60, 90, 20};
  const auto at = [](double right, double up) {
    return Vec3(-std::cos(up * kDegree) * std::sin(right * kDegree), std::sin(up * kDegree),
                std::cos(up * kDegree) * std::cos(right * kDegree));
  };
  expect_shows(part, {90, 60}, at(90, 20));
  expect_shows(part, {0, 60}, at(45, 20));
  expect_shows(part, {180, 0}, at(135, 50));
  expect_shows(part, {90, 120}, at(90, -10));
  EXPECT_FALSE(part.px_from_dir(at(44, 20)));
  EXPECT_FALSE(part.px_from_dir(at(90, 51)));
  // A whole one is a lat-long.
  const LatLong whole{{400, 200}};
  for (double x = 3; x < 400; x += 31) expect_shows(Panorama{{400, 200}}, {x, 70}, *whole.dir_from_px({x, 70}));
}

TEST(Projection, WhatIsCroppedStaysWhereItWas) {
  const Panorama part{{180, 120}, 90, 60, 90, 20};
  const Panorama crop = cropped(part, 30, 12, {100, 80});
  EXPECT_TRUE((crop.size == Size{100, 80}));
  for (const Vec2& px : {Vec2(0, 0), Vec2(50, 40), Vec2(99, 3)}) {
    expect_shows(crop, px, *part.dir_from_px(px + Vec2(30, 12)));
  }
  EXPECT_THROW(cropped(part, 100, 0, {81, 10}), Error);
  EXPECT_THROW(cropped(part, -1, 0, {10, 10}), Error);
}

TEST(Projection, AScanWithoutVerticalFieldHasSquarePixels) {
  const auto of = [](const std::string& text, Size size) {
    return std::get<Panorama>(projection_from_text(text, size).value());
  };
  EXPECT_NEAR(of("panorama fov=360", {3600, 1200}).vfov_degrees, 120, 1e-12);
  EXPECT_NEAR(of("panorama fov=180 elevation=10", {1000, 500}).vfov_degrees, 90, 1e-12);
  EXPECT_TRUE(std::holds_alternative<LatLong>(projection_from_text("panorama", {200, 100}).value()));
  EXPECT_TRUE((picture_of_width("panorama fov=120 vfov=60", 900).value().size == Size{900, 450}));
  EXPECT_TRUE((picture_of_width("panorama fov=90", 900).value().size == Size{900, 450}));
  EXPECT_THROW(projection_from_text("panorama fov=370 vfov=60", {370, 60}), Error);
  EXPECT_THROW(projection_from_text("panorama fov=180 vfov=90 elevation=50", {200, 100}), Error);
  EXPECT_THROW(projection_from_text("panorama", {200, 150}), Error) << "270 degrees high";
}

TEST(Projection, AngularMapIsPinned) {
  const AngularMap map{inscribed_disc(200)};
  expect_shows(map, {100, 100}, {0, 0, 1});
  expect_shows(map, {150, 100}, {-1, 0, 0});  // image right = -X
  expect_shows(map, {100, 50}, {0, 1, 0});
  expect_shows(map, {200, 100}, {0, 0, -1});
  EXPECT_FALSE(map.dir_from_px({199, 1}));
}

TEST(Projection, FarMirrorBallIsPinned) {
  const MirrorBall ball{{100, 100, 80}};
  const double s = std::sin(45 * kDegree);
  expect_shows(ball, {100, 100}, {0, 0, 1});           // the photographer
  expect_shows(ball, {100 + 80 * s, 100}, {1, 0, 0});  // image right = +X
  expect_shows(ball, {100, 100 - 80 * s}, {0, 1, 0});
  expect_shows(ball, {180, 100}, {0, 0, -1});
  EXPECT_FALSE(ball.dir_from_px({181, 100}));
}

// The normal at 30 degrees of a ball at D = 2 lies at (.5, 0, .866); from there the camera is at (-.5, 0, 1.134),
// 23.794 degrees from +Z on the other side, so the ball shows 2 * 30 + 23.794 degrees there. In the picture that is
// tan(23.794) / tan(asin(1/2)) = .7638 of the radius.
TEST(Projection, NearMirrorBallIsPinned) {
  const MirrorBall ball{{100, 100, 80}, 2};
  const double beta = std::atan2(0.5, 2 - std::sqrt(0.75));
  EXPECT_NEAR(beta / kDegree, 23.794, 1e-3);
  const double shown = 60 * kDegree + beta;
  expect_shows(ball, {100 + 80 * std::tan(beta) * std::sqrt(3.0), 100}, {std::sin(shown), 0, std::cos(shown)});
  // At the outline the ray grazes: it goes on as it came, 30 degrees from -Z, and what is nearer to -Z is hidden.
  expect_shows(ball, {180, 100}, {0.5, 0, -std::sqrt(0.75)});
  EXPECT_FALSE(ball.px_from_dir({std::sin(29 * kDegree), 0, -std::cos(29 * kDegree)}));
  EXPECT_TRUE(ball.px_from_dir({std::sin(31 * kDegree), 0, -std::cos(31 * kDegree)}));
}

TEST(Projection, AMirrorBallFarAwayIsAFarMirrorBall) {
  const MirrorBall far{{100, 100, 80}}, near{{100, 100, 80}, 1e6};
  for (double x = 22; x < 180; x += 7) {
    EXPECT_LT((*far.dir_from_px({x, 103}) - *near.dir_from_px({x, 103})).norm(), 1e-5);
  }
}

TEST(Projection, MirrorBallInverseIsExactAtAnyDistance) {
  for (const double distance : {1.0001, 1.05, 1.5, 3.0, 47.0, 1e4}) {
    const MirrorBall ball{{0, 0, 1}, distance};
    for (double x = 0; x < 1; x += 0.01) {
      const auto back = ball.px_from_dir(*ball.dir_from_px({x, 0}));
      ASSERT_TRUE(back) << "D = " << distance << ", x = " << x;
      EXPECT_NEAR(back->x(), x, 1e-10) << "D = " << distance;
    }
  }
}

TEST(Projection, RectilinearIsPinned) {
  const Rectilinear camera{{200, 100}, 90};
  expect_shows(camera, {100, 50}, {0, 0, 1});
  expect_shows(camera, {200, 50}, Vec3(-1, 0, 1).normalized());  // image right = -X
  expect_shows(camera, {100, 0}, Vec3(0, 0.5, 1).normalized());
  EXPECT_FALSE(camera.px_from_dir({0, 0, -1}));
}

TEST(Projection, FisheyesArePinned) {
  // 45 degrees to image right of a lens that sees 180: the radius is f(45) / f(90).
  const auto shown = Vec3(-1, 0, 1).normalized();
  const Disc disc = inscribed_disc(200);
  const double s = std::sin(45 * kDegree), t = std::sin(22.5 * kDegree);
  expect_shows(Fisheye{disc, 180, Lens::kEquidistant}, {150, 100}, shown);
  expect_shows(Fisheye{disc, 180, Lens::kEquisolid}, {100 + 100 * t / s, 100}, shown);
  expect_shows(Fisheye{disc, 180, Lens::kStereographic}, {100 + 100 * (std::sqrt(2.0) - 1), 100}, shown);
  expect_shows(Fisheye{disc, 180, Lens::kOrthographic}, {100 + 100 * s, 100}, shown);
  expect_shows(Fisheye{disc, 180, Lens::kEquidistant}, {100, 0}, {0, 1, 0});
  // Kannala & Brandt with k1 = -0.1 at 1 and 1.5 radians: .9 against 1.5 (1 - .225) = 1.1625.
  const Fisheye kb{disc, 3 / kDegree, Lens::kKannalaBrandt, {-0.1, 0, 0, 0}};
  expect_shows(kb, {100, 100 - 100 * 0.9 / 1.1625}, {0, std::sin(1.0), std::cos(1.0)});
  const Fisheye polynomial{disc, 3 / kDegree, Lens::kPolynomial, {-0.1, 0, 0, 0}};
  expect_shows(polynomial, {100, 100 - 100 * 0.9 / 1.275}, {0, std::sin(1.0), std::cos(1.0)});
}

TEST(Projection, AFisheyeOf360DegreesIsAnAngularMap) {
  const Fisheye fisheye{inscribed_disc(200), 360};
  const AngularMap map{inscribed_disc(200)};
  for (double x = 3; x < 200; x += 13) expect_shows(fisheye, {x, 110}, *map.dir_from_px({x, 110}));
}

TEST(Projection, DistortionIsOpenCvs) {
  // cv::projectPoints of (0.5, 0.25, 1), K = I, with k1 k2 p1 p2 k3 = -.2 .05 .01 -.02 .003, by hand: r2 = .3125,
  // radial = 1 - .0625 + .0048828125 + .000091552734 = .942474365; x' = .4712371825 + .0025 - .02 * .8125,
  // y' = .23561859125 + .01 * .4375 - .005.
  const BrownConrady d{-0.2, 0.05, 0.01, -0.02, 0.003};
  const Rectilinear camera{{200, 200}, 90, d};  // a focal length of 100 px
  const auto px = camera.px_from_dir(Vec3(-0.5, -0.25, 1).normalized());
  ASSERT_TRUE(px);
  EXPECT_NEAR(px->x(), 100 + 100 * (0.4712371826171875 + 0.0025 - 0.01625), 1e-9);
  EXPECT_NEAR(px->y(), 100 + 100 * (0.23561859130859375 + 0.004375 - 0.005), 1e-9);
}

TEST(Projection, OctahedraArePinned) {
  for (const bool equal_area : {false, true}) {
    const Octahedral map{{200, 200}, equal_area};
    expect_shows(map, {100, 100}, {0, 1, 0});
    expect_shows(map, {200, 100}, {1, 0, 0});
    expect_shows(map, {100, 200}, {0, 0, 1});
    expect_shows(map, {0, 0}, {0, -1, 0});
    expect_shows(map, {200, 200}, {0, -1, 0});
  }
  // In the middle of an edge of the upper half's triangle |x| = |z|, y = 0.
  expect_shows(Octahedral{{200, 200}}, {150, 150}, Vec3(1, 0, 1).normalized());
  // pbrt-v4's EqualAreaSquareToSphere({.75, .5}) = (x, y, z) with r = .5: z = 1 - r^2 = .75, x = r sqrt(2 - r^2).
  expect_shows(Octahedral{{200, 200}, true}, {150, 100}, {0.5 * std::sqrt(1.75), 0.75, 0});
}

TEST(Projection, HemisphereAndParaboloidsArePinned) {
  const Hemisphere dome{inscribed_disc(200)};
  expect_shows(dome, {100, 100}, {0, 1, 0});
  expect_shows(dome, {100, 200}, {0, 0, 1});
  expect_shows(dome, {200, 100}, {-1, 0, 0});
  EXPECT_FALSE(dome.px_from_dir({0, -0.1, 0.995}));
  const DualParaboloid map{{400, 200}};
  expect_shows(map, {100, 100}, {0, 0, 1});
  expect_shows(map, {200, 100}, {-1, 0, 0});
  expect_shows(map, {100, 0}, {0, 1, 0});
  expect_shows(map, {300, 100}, {0, 0, -1});
  expect_shows(map, {350, 100}, {0.8, 0, -0.6});  // half way out: 2 atan(1/2)
}

TEST(Projection, GeometryThatCannotBeIsOneHelpfulLine) {
  const auto complaint = [](const Projection& projection) -> std::string {
    try {
      require_valid(projection);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  const Disc disc = inscribed_disc(100);
  EXPECT_NE(complaint(Fisheye{disc, 361}).find("at most 360"), std::string::npos) << complaint(Fisheye{disc, 361});
  EXPECT_NE(complaint(Fisheye{disc, 190, Lens::kOrthographic}).find("at most 180"), std::string::npos);
  EXPECT_NE(complaint(Fisheye{disc, 360, Lens::kStereographic}), "accepted");
  EXPECT_NE(complaint(Fisheye{disc, 200, Lens::kKannalaBrandt, {-0.5, 0, 0, 0}}).find("stops rising"),
            std::string::npos);
  EXPECT_NE(complaint(Cube{Cube::Layout::kFaces, 30, Convention::kBlender}).find("openexr, opengl"), std::string::npos);
  EXPECT_NE(complaint(LatLong{{20, 10}, Convention::kOpenGl}), "accepted");
  EXPECT_EQ(complaint(Fisheye{disc, 360}), "accepted");
}

TEST(Projection, ACameraInsideTheBallIsAnError) {
  const MirrorBall ball{{100, 100, 80}, 1};
  EXPECT_THROW(ball.dir_from_px({100, 100}), Error);
  EXPECT_THROW(ball.px_from_dir({0, 0, 1}), Error);
  EXPECT_THROW(require_valid(ball), Error);
}

TEST(ProjectionText, NumbersSurviveExactly) {
  Random random(7, 1);
  for (int k = 0; k < 200; ++k) {
    const Size size{1 + static_cast<int>(random.bits() % 5000), 1 + static_cast<int>(random.bits() % 5000)};
    const Disc disc{1000 * random.uniform(), 1e-3 * random.uniform(), 1e5 * random.uniform() + 1e-9};
    const double distance = k % 2 ? kFar : 1 + 50 * random.uniform() + 1e-6;
    const auto ball =
        std::get<MirrorBall>(*projection_from_text(text_from_projection(MirrorBall{disc, distance}), size));
    EXPECT_EQ(ball.disc.cx, disc.cx);
    EXPECT_EQ(ball.disc.cy, disc.cy);
    EXPECT_EQ(ball.disc.r, disc.r);
    EXPECT_EQ(ball.distance, distance);
    const auto map = std::get<AngularMap>(*projection_from_text(text_from_projection(AngularMap{disc}), size));
    EXPECT_EQ(map.disc.r, disc.r);
    const double fov = 1 + 170 * random.uniform();
    const auto camera =
        std::get<Rectilinear>(*projection_from_text(text_from_projection(Rectilinear{size, fov}), size));
    EXPECT_EQ(camera.fov_degrees, fov);
    EXPECT_EQ(camera.size, size);
  }
}

TEST(ProjectionText, IsPinned) {
  EXPECT_EQ(text_from_projection(LatLong{{8, 4}}), "latlong");
  EXPECT_EQ(text_from_projection(AngularMap{inscribed_disc(64)}), "angular");
  EXPECT_EQ(text_from_projection(MirrorBall{{1000.5, 750, 600}, 20}), "mirror-ball cx=1000.5 cy=750 r=600 distance=20");
  EXPECT_EQ(text_from_projection(Rectilinear{{8, 4}, 60}), "rectilinear fov=60");
  EXPECT_EQ(text_from_projection(LatLong{{8, 4}, Convention::kBlender}), "latlong convention=blender");
  EXPECT_EQ(text_from_projection(Fisheye{{10, 11, 12}, 190, Lens::kKannalaBrandt, {0.5, 0, -0.25, 0}}),
            "fisheye cx=10 cy=11 r=12 fov=190 lens=kannala-brandt k1=0.5 k3=-0.25");
  EXPECT_EQ(text_from_projection(Cube{Cube::Layout::kVerticalStrip, 4, Convention::kOpenGl}),
            "cube-strip convention=opengl");
  EXPECT_EQ(text_from_projection(Panorama{{8, 4}, 180, 90, 30, 0}), "panorama fov=180 vfov=90 azimuth=30");
}

TEST(ProjectionText, WhatIsWrittenIsReadBack) {
  for (const char* text :
       {"latlong", "latlong convention=pbrt", "angular", "mirror-ball", "fisheye fov=190 lens=polynomial k2=0.01",
        "rectilinear fov=70 k1=-0.1 p2=0.001", "cube-cross", "cube-cross-vertical", "cube-strip convention=threejs",
        "cube-faces convention=opengl", "octahedral equal-area=1", "octahedral", "hemisphere", "dual-paraboloid",
        "panorama fov=360 vfov=100 elevation=-20", "panorama fov=120 vfov=70 azimuth=33.5 elevation=2"}) {
    const auto made = picture_of_width(text, 120);
    ASSERT_TRUE(made) << text;
    const std::string tag = text_from_projection(made->projection);
    const auto back = projection_from_text(tag, made->size);
    ASSERT_TRUE(back) << tag;
    EXPECT_EQ(text_from_projection(*back), tag);
    Random random(3, 5);
    for (int k = 0; k < 50; ++k) {
      const Vec3 d = test::random_direction(random);
      const auto a = px_from_dir(made->projection, d), b = px_from_dir(*back, d);
      ASSERT_EQ(a.has_value(), b.has_value()) << tag;
      if (a) {
        EXPECT_LT((*a - *b).norm(), 1e-9) << tag;
      }
    }
  }
}

TEST(ProjectionText, ACubesShapeSaysItsLayout) {
  EXPECT_EQ(std::get<Cube>(*projection_from_text("cube-cross", {400, 300})).layout, Cube::Layout::kHorizontalCross);
  EXPECT_EQ(std::get<Cube>(*projection_from_text("cube-cross", {300, 400})).layout, Cube::Layout::kVerticalCross);
  EXPECT_EQ(std::get<Cube>(*projection_from_text("cube-strip", {60, 10})).layout, Cube::Layout::kHorizontalStrip);
  EXPECT_THROW(projection_from_text("cube-cross", {401, 300}), Error);
  EXPECT_THROW(projection_from_text("cube-strip", {10, 61}), Error);
  EXPECT_THROW(picture_of_width("cube-cross", 401), Error);
  EXPECT_THROW(projection_from_text("dual-paraboloid", {100, 100}), Error);
  EXPECT_THROW(projection_from_text("octahedral", {100, 50}), Error);
}

TEST(ProjectionText, ABareNameTakesDefaults) {
  const auto ball = std::get<MirrorBall>(*projection_from_text("mirror-ball", {300, 200}));
  EXPECT_EQ(ball.disc.cx, 150);
  EXPECT_EQ(ball.disc.cy, 100);
  EXPECT_EQ(ball.disc.r, 100);
  EXPECT_TRUE(std::isinf(ball.distance));
  EXPECT_EQ(std::get<LatLong>(*projection_from_text("lat-long", {8, 4})).size, (Size{8, 4}));
}

TEST(ProjectionText, NonsenseIsUnknown) {
  for (const char* text : {"", "cube", "angular fov=3", "mirror-ball cx", "mirror-ball r=", "mirror-ball r=3x",
                           "mirror-ball r=nan", "mirror-ball r=3 r=4", "latlong 7"}) {
    EXPECT_FALSE(projection_from_text(text, {100, 100})) << text;
  }
  EXPECT_THROW(projection_from_text("mirror-ball distance=0.5", {100, 100}), Error);
  EXPECT_THROW(projection_from_text("mirror-ball r=-4", {100, 100}), Error);
  EXPECT_THROW(projection_from_text("rectilinear fov=180", {100, 100}), Error);
}

TEST(ProjectionOfProbe, FromThenTagThenShape) {
  const Size wide{200, 100}, square{100, 100};
  EXPECT_TRUE(std::holds_alternative<AngularMap>(projection_of_probe("angular", "latlong", wide, "p.exr")));
  EXPECT_TRUE(std::holds_alternative<AngularMap>(projection_of_probe("", "angular", wide, "p.exr")));
  EXPECT_TRUE(std::holds_alternative<LatLong>(projection_of_probe("", "", wide, "p.exr")));
  const Projection ball = projection_of_probe("mirror-ball", "mirror-ball cx=40 cy=50 r=30", square, "p.exr");
  EXPECT_EQ(std::get<MirrorBall>(ball).disc.r, 30) << "a bare name keeps the geometry that the file carries";
}

TEST(ProjectionOfProbe, AnErrorNamesTheFileAndTheRemedy) {
  for (const auto& [from, tag] : {std::pair{"", ""}, std::pair{"cube", ""}, std::pair{"", "cube"}}) {
    try {
      projection_of_probe(from, tag, {100, 99}, "p.exr");
      ADD_FAILURE() << "from '" << from << "', tag '" << tag << "' was accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("p.exr: "), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("--from"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace hdr
