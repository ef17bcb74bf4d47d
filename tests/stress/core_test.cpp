// Directions at poles and seams, sizes beyond 32 bits, threads from 1 to 64.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "libhdr/core/color.h"
#include "libhdr/core/image.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/random.h"
#include "libhdr/core/sphere.h"
#include "tests/stress/hostile.h"

namespace hdr::stress {
namespace {

RC_GTEST_PROP(CoreStress, DirectionsComeBack, ()) {
  const Vec3 d = *direction();
  const Vec2 uv = latlong_from_dir(d);
  RC_ASSERT(uv.x() >= 0 && uv.x() < 1 && uv.y() >= 0 && uv.y() <= 1);
  RC_ASSERT((dir_from_latlong(uv.x(), uv.y()) - d).norm() < 2e-15);
}

// Whatever its length: 1e-160 squared is nothing, and a direction all the same.
RC_GTEST_PROP(CoreStress, TheLengthOfADirectionDoesNotMatter, ()) {
  const Vec3 d = *direction();
  const double scale = *power_of_ten(-160, 150);
  const Vec2 uv = latlong_from_dir(d), other = latlong_from_dir(scale * d);
  RC_ASSERT(std::abs(uv.y() - other.y()) < 1e-12);
  // Near a pole the azimuth of a scaled direction may have rounded away with its components.
  const double across = std::sin(kPi * uv.y()) * std::remainder(uv.x() - other.x(), 1);
  RC_ASSERT(std::abs(across) < 1e-12);
}

// Each pixel's solid angle to the last digits, from 1x1 to a column of 100 000, poles too, where 1 - cos cancels.
RC_GTEST_PROP(CoreStress, SolidAnglesAreThoseOfLongDouble, ()) {
  using Long = long double;
  const int height = *rc::gen::oneOf(rc::gen::inRange(1, 2000), rc::gen::element(1, 2, 100000));
  const int width = *rc::gen::element(1, 2, 3, 200000);
  constexpr Long pi = std::numbers::pi_v<Long>;
  Long sum = 0;
  for (int y = 0; y < height; ++y) {
    const Long top = pi * y / height, bottom = pi * (y + 1) / height;
    const Long truth = 4 * pi / width * std::sin((top + bottom) / 2) * std::sin((bottom - top) / 2);
    const double ours = latlong_pixel_solid_angle(y, width, height);
    RC_ASSERT(std::abs(ours / truth - 1) < 1e-10L);  // near the lower pole pi has its own rounding
    sum += ours;
  }
  RC_ASSERT(std::abs(sum * width - 4 * pi) < 1e-12L);
}

RC_GTEST_PROP(CoreStress, TangentsAreOrthonormal, ()) {
  const Vec3f n = (*direction()).cast<float>().normalized();
  Vec3f t, b;
  tangents_from_normal(n, t, b);
  for (const float product : {t.dot(b), t.dot(n), b.dot(n), t.norm() - 1, b.norm() - 1}) {
    RC_ASSERT(std::abs(product) < 1e-6f);
  }
  RC_ASSERT(t.cross(b).dot(n) > 0.999f);
}

RC_GTEST_PROP(CoreStress, SrgbComesBack, ()) {
  const double x = *rc::gen::element(0.0, 1.0, 0.0031308, 1e-300, -1.0, 2.0, 1e300) + *power_of_ten(-12, -1);
  const double there = srgb_from_linear(x);
  RC_ASSERT(there >= 0 && there <= 1);
  RC_ASSERT(std::abs(linear_from_srgb(there) - std::clamp(x, 0.0, 1.0)) < 1e-6);
}

// Every row once, in blocks of the grain, whatever the counts and the threads; and the joined sum has the same bits.
RC_GTEST_PROP(CoreStress, RowsAreDoneOnceByAnyNumberOfThreads, ()) {
  const int count = *rc::gen::oneOf(rc::gen::inRange(0, 300), rc::gen::element(0, 1, 100000));
  const int grain = *rc::gen::element(1, 2, 3, 16, 1000, 1000000);
  const auto summed = [&](int thread_count) {
    set_threads(thread_count);
    std::atomic<int> rows = 0;
    const double sum = reduce_rows(
        count, grain, 0.0,
        [&](int first, int last) {
          rows += last - first;
          double part = 0;
          for (int y = first; y < last; ++y) part += std::sqrt(y) * 1e-3;
          return part;
        },
        [](double& total, double part) { total += part; });
    set_threads(0);
    RC_ASSERT(rows == count);
    return sum;
  };
  const double one = summed(1);
  RC_ASSERT(summed(*rc::gen::inRange(2, 65)) == one);
}

// Counts and grains near the largest int: their sum is not one.
TEST(CoreStress, RowsUpToTheLastIntAreDoneOnce) {
  constexpr int kMost = std::numeric_limits<int>::max();
  for (const int grain : {kMost, kMost - 1, 1 << 30}) {
    std::atomic<std::int64_t> rows = 0;
    for_rows(kMost, grain, [&](int first, int last) {
      EXPECT_LE(0, first);
      EXPECT_LT(first, last);
      rows += last - first;
    });
    EXPECT_EQ(rows, kMost) << "grain " << grain;
    const auto count = [](int first, int last) { return std::int64_t{last} - first; };
    EXPECT_EQ(reduce_rows(kMost, grain, std::int64_t{0}, count, [](auto& total, auto part) { total += part; }), kMost);
  }
}

// A size whose bytes 64 bits do not hold must not come out as a small one.
TEST(CoreStress, APictureOfMoreThan64BitsIsRefused) {
  constexpr int kMost = std::numeric_limits<int>::max();
  EXPECT_THROW(Image<double>(kMost, kMost, 1 << 20), std::bad_alloc);
  EXPECT_THROW(Image<float>(1 << 22, 1 << 22, 1 << 18), std::bad_alloc) << "2^64 bytes: none, were they cut to 64 bits";
  EXPECT_THROW(Image<float>(kMost, kMost, 4), std::bad_alloc);
}

RC_GTEST_PROP(CoreStress, WhatARowThrowsArrives, ()) {
  const int count = *rc::gen::inRange(1, 200), grain = *rc::gen::inRange(1, 20), bad = *rc::gen::inRange(0, count);
  set_threads(*rc::gen::inRange(1, 65));
  bool thrown = false;
  try {
    for_rows(count, grain, [&](int first, int last) {
      if (first <= bad && bad < last) throw Error("row");
    });
  } catch (const Error&) {
    thrown = true;
  }
  set_threads(0);
  RC_ASSERT(thrown);
}

RC_GTEST_PROP(CoreStress, RandomNumbersAreBelowOne, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>(), *rc::gen::arbitrary<std::uint64_t>());
  for (int k = 0; k < 100; ++k) {
    const double u = random.uniform();
    const float v = random.uniform_float();
    RC_ASSERT(u >= 0 && u < 1 && v >= 0 && v < 1 && std::isfinite(random.normal()));
  }
}

}  // namespace
}  // namespace hdr::stress
