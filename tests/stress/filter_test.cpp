// Filters under hostile pictures. A blur moves light: means lie between the least and the largest, one value stays, a
// lat-long may begin at any meridian.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/sphere.h"
#include "libhdr/filter/blur.h"
#include "libhdr/filter/compare.h"
#include "libhdr/filter/fuse.h"
#include "libhdr/filter/resize.h"
#include "libhdr/filter/tonemap.h"
#include "tests/stress/hostile.h"

namespace hdr::stress {
namespace {

/// Columns moved to the right, round and round.
Image<float> turned(View<const float> map, int columns) {
  Image<float> out(map.size(), map.channels());
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      for (int c = 0; c < map.channels(); ++c) out((x + columns) % map.width(), y, c) = map(x, y, c);
    }
  }
  return out;
}

double sum_of(View<const float> map, bool sphere) {
  double sum = 0;
  for (int y = 0; y < map.height(); ++y) {
    const double weight = sphere ? latlong_pixel_solid_angle(y, map.width(), map.height()) : 1;
    for (int k = 0; k < map.width() * map.channels(); ++k) sum += weight * map.row(y)[k];
  }
  return sum;
}

/// Denormals have few digits, and their products none: the law holds to the smallest normal float.
constexpr double kNormal = 1.2e-38;

void expect_mean(View<const float> blurred, View<const float> map, double tolerance) {
  RC_ASSERT(fault_of(blurred) == "");
  RC_ASSERT(smallest_of(blurred) >= smallest_of(map) * (1 - tolerance) - kNormal);
  RC_ASSERT(largest_of(blurred) <= largest_of(map) * (1 + tolerance) + kNormal);
}

RC_GTEST_PROP(FilterStress, AGaussianIsAMean, ()) {
  const MapPlan plan = *any_map(48);
  const double sigma = *rc::gen::oneOf(power_of_ten(-6, 3), rc::gen::element(4.0, 3.999, 1e5, 3e8, 1e9, 1e300));
  const Image<float> map = made(plan);
  expect_mean(gaussian_blur(map, sigma), map, 1e-4);
}

RC_GTEST_PROP(FilterStress, AGaussianOnTheSphereIsAMeanAndHasNoSeam, ()) {
  const MapPlan plan = *any_latlong(48);
  const double sigma = *rc::gen::oneOf(power_of_ten(-6, 3), rc::gen::element(1e5, 1e9, 1e300));
  const Image<float> map = made(plan);
  const Image<float> blurred = gaussian_blur(map, sigma, Surface::kLatLong);
  expect_mean(blurred, map, 1e-5);
  const int columns = *rc::gen::inRange(0, plan.width);
  const Image<float> once = turned(blurred, columns);
  const Image<float> other = gaussian_blur(turned(map, columns), sigma, Surface::kLatLong);
  // Waves round to 1e-16 of the brightest light, and that is what may differ.
  const double most = largest_of(map);
  for (int y = 0; y < map.height(); ++y) {
    for (std::size_t k = 0; k < map.row_samples(); ++k) {
      RC_ASSERT(std::abs(once.row(y)[k] - other.row(y)[k]) <= 2e-7 * once.row(y)[k] + 1e-13 * most);
    }
  }
}

RC_GTEST_PROP(FilterStress, AMotionIsAMeanAndHasNoSeam, ()) {
  const MapPlan plan = *any_latlong(48);
  const double length = *rc::gen::oneOf(power_of_ten(-3, 2), rc::gen::element(1.0, 2.0, 3.0, 300.0));
  const double degrees = *rc::gen::element(0.0, 90.0, 180.0, 45.0, 1e-9, -30.0, 1e6);
  const auto surface = *rc::gen::element(Surface::kPlane, Surface::kLatLong);
  const Image<float> map = made(plan);
  const Image<float> blurred = motion_blur(map, length, degrees, surface);
  expect_mean(blurred, map, 1e-4);
  if (surface == Surface::kPlane) return;
  const int columns = *rc::gen::inRange(0, plan.width);
  const Image<float> once = turned(blurred, columns);
  const Image<float> other = motion_blur(turned(map, columns), length, degrees, surface);
  const double most = largest_of(map);
  for (int y = 0; y < map.height(); ++y) {
    for (std::size_t k = 0; k < map.row_samples(); ++k) {
      RC_ASSERT(std::abs(once.row(y)[k] - other.row(y)[k]) <= 1e-5 * once.row(y)[k] + 1e-12 * most);
    }
  }
}

// A sun of 1e12 beside light of 1: what is lost or found must be small against the light beside it, too.
TEST(FilterStress, ASunDoesNotDarkenItsNeighbours) {
  Image<float> map(400, 3, 3);
  for (int y = 0; y < 3; ++y) {
    for (std::size_t k = 0; k < map.row_samples(); ++k) map.row(y)[k] = 1e-9f;
  }
  for (int c = 0; c < 3; ++c) map(20, 1, c) = 1e12f;
  for (const Surface surface : {Surface::kPlane, Surface::kLatLong}) {
    const Image<float> moved = motion_blur(map, 9, 0, surface);
    for (int x = 40; x < 380; ++x) EXPECT_NEAR(moved(x, 1), 1e-9f, 1e-15f) << x;
  }
}

RC_GTEST_PROP(FilterStress, BlursLoseNoLight, ()) {
  const MapPlan plan = *any_latlong(40);
  const Image<float> map = made(plan);
  const double sigma = *power_of_ten(-1, 2), before = sum_of(map, false);
  RC_ASSERT(std::abs(sum_of(gaussian_blur(map, sigma), false) - before) <= 2e-4 * before + 1e-38);
}

RC_GTEST_PROP(FilterStress, ResizedPicturesAreMeans, ()) {
  const MapPlan plan = *any_map(48);
  const Image<float> map = made(plan);
  const Size size{*rc::gen::element(1, 2, 17, 48, 300), *rc::gen::element(1, 2, 17, 48, 300)};
  const Image<float> other = resize(map, size);
  RC_ASSERT(other.size() == size);
  expect_mean(other, map, 1e-5);
}

// To look at anything: whatever the numbers, codes come out, and grey stays grey.
RC_GTEST_PROP(FilterStress, AnythingCanBeLookedAt, ()) {
  const MapPlan plan = *any_map(40);
  Image<float> map = made(plan);
  if (*rc::gen::element(false, true)) spoil(map, plan.seed);
  const double stops = *rc::gen::element(0.0, -60.0, 60.0, 1000.0, -1000.0);
  RC_ASSERT(std::isfinite(metered_stops(map)));
  for (const ToneOperator tone :
       {ToneOperator::kReinhard, ToneOperator::kFilmic, ToneOperator::kLocal, ToneOperator::kClip}) {
    RC_ASSERT(tonemap(map, stops, {}, tone).size() == map.size());
  }
  const FalseColour colours = false_colour(map, stops);
  RC_ASSERT(colours.picture.width() > 0 && colours.lowest <= colours.highest);
}

RC_GTEST_PROP(FilterStress, ComparisonsCountWhatIsNoNumber, ()) {
  const MapPlan plan = *any_map(40);
  const Image<float> map = made(plan);
  Image<float> other = map.clone();
  const bool spoiled = *rc::gen::element(false, true);
  if (spoiled) spoil(other, plan.seed);
  std::int64_t nonfinite = 0;
  for (int y = 0; y < other.height(); ++y) {
    for (std::size_t k = 0; k < other.row_samples(); ++k) nonfinite += !std::isfinite(other.row(y)[k]);
  }
  for (const CompareScale scale : {CompareScale::kNone, CompareScale::kGlobal, CompareScale::kChannel}) {
    const Comparison compared = compare(map, other, scale);
    RC_ASSERT(compared.nonfinite[0] == 0 && compared.nonfinite[1] == nonfinite);
    RC_ASSERT(!std::isnan(compared.rel_rmse) && std::isfinite(compared.median_abs_log2));
    RC_ASSERT(spoiled || (compared.rel_rmse < 1e-7 && compared.max_abs <= 1e-7 * largest_of(map)));
  }
}

RC_GTEST_PROP(FilterStress, AnyShotsCanBeFused, ()) {
  const BracketCase plan = *any_bracket(24);
  const Image<float> fused =
      fuse(plan.shots, [&](int k) { return std::move(made(plan).shots[static_cast<std::size_t>(k)]); });
  RC_ASSERT(fault_of(fused) == "");
  RC_ASSERT(largest_of(fused) <= 1);
}

}  // namespace
}  // namespace hdr::stress
