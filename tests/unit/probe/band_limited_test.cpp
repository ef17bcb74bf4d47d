// Any full-sphere projection to any other and back, by numbers: a map that is band-limited to a quarter of Nyquist, in
// pictures that have as many pixels on the sphere.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/unwrap.h"
#include "tests/unit/probe/made_up_environments.h"

namespace hdr {
namespace {

constexpr int kWidth = 512;  // of the lat-long: Nyquist is 256 waves around the equator, its quarter 64
constexpr double kMostWaves = 64;

/// Plane waves exp(i k . d): on the sphere a wave of |k| radians per radian is of degree |k| and no more to speak of.
class BandLimited {
 public:
  explicit BandLimited(std::uint64_t seed) {
    Random random(seed, 9);
    for (int n = 0; n < kWaves; ++n) {
      // As many waves of a length as there are harmonics of its degree.
      waves_.push_back({test::random_direction(random) * (kMostWaves * std::sqrt(random.uniform())),
                        2 * kPi * random.uniform(), 2 * kPi / 3 * random.uniform()});
    }
  }
  double operator()(const Vec3& d, int channel) const {
    double sum = 0;
    for (const Wave& w : waves_) sum += std::sin(w.k.dot(d) + w.phase + channel * w.shift);
    return 1 + 0.9 * sum / std::sqrt(1.0 * kWaves) * 0.3;
  }

 private:
  static constexpr int kWaves = 24;
  struct Wave {
    Vec3 k;
    double phase, shift;
  };
  std::vector<Wave> waves_;
};

struct Errors {
  double psnr = 0, total = 0;  ///< dB below the map's largest value; relative error of the integral over the sphere
};

/// Over the directions that are not within `cone` degrees of `hidden`, which a ball shows badly.
Errors compare(const Image<float>& a, const Image<float>& truth, double cone, const Vec3& hidden) {
  double squares = 0, weight = 0, sum_a = 0, sum_truth = 0, peak = 0;
  for (int y = 0; y < truth.height(); ++y) {
    const double w = latlong_pixel_solid_angle(y, truth.width(), truth.height());
    for (int x = 0; x < truth.width(); ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / truth.width(), (y + 0.5) / truth.height());
      if (cone > 0 && d.dot(hidden) > std::cos(cone * kDegree)) continue;
      for (int c = 0; c < 3; ++c) {
        const double t = truth(x, y, c), e = a(x, y, c) - t;
        squares += w * e * e;
        weight += w;
        sum_a += w * a(x, y, c);
        sum_truth += w * t;
        peak = std::max(peak, t);
      }
    }
  }
  return {10 * std::log10(peak * peak * weight / squares), sum_a / sum_truth - 1};
}

struct Case {
  const char* text;
  double pixels_per_sphere;  ///< of a picture of width 1
  double cone = 0;
};

class ThereAndBack : public testing::TestWithParam<Case> {};

TEST_P(ThereAndBack, KeepsABandLimitedMap) {
  const Case& c = GetParam();
  const double pixels = kWidth * kWidth / 2;
  const int step = std::string(c.text).starts_with("cube-cross") ? 12 : 2;
  const int width = static_cast<int>(std::ceil(std::sqrt(pixels / c.pixels_per_sphere) / step)) * step;
  const auto picture = picture_of_width(c.text, width);
  ASSERT_TRUE(picture);
  for (const std::uint64_t seed : {1u, 2u}) {
    const Image<float> source = test::latlong_of(kWidth, BandLimited(seed));
    const Mat3 turn = rotation_from_degrees({20.0 * static_cast<double>(seed - 1), 35, 0});
    const LatLong latlong{source.size()};
    const Image<float> there = resample(source, latlong, picture->projection, picture->size, turn);
    const Image<float> back = resample(there, picture->projection, latlong, source.size(), turn.transpose());
    const Errors e = compare(back, source, c.cone, turn * -Vec3::UnitZ());
    EXPECT_GT(e.psnr, 50) << c.text << " of width " << width;
    EXPECT_LT(std::abs(e.total), 1e-3) << c.text << " of width " << width;
  }
}

INSTANTIATE_TEST_SUITE_P(Projections, ThereAndBack,
                         testing::Values(Case{"latlong", 0.5}, Case{"angular", kPi / 4},
                                         Case{"mirror-ball", kPi / 4, 25},
                                         Case{"fisheye fov=360 lens=equisolid", kPi / 4, 25},
                                         Case{"cube-cross", 6.0 / 16}, Case{"cube-cross-vertical", 6.0 / 9},
                                         Case{"cube-strip", 6.0}, Case{"octahedral", 1.0},
                                         Case{"octahedral equal-area=1", 1.0}, Case{"dual-paraboloid", kPi / 8},
                                         Case{"latlong convention=pbrt", 0.5}));

TEST(Rotation, TwelveStepsOfThirtyDegreesKeepTheMap) {
  const Image<float> source = test::latlong_of(kWidth, BandLimited(5));
  const LatLong latlong{source.size()};
  for (const Vec3& axis : {Vec3(0, 30, 0), Vec3(30, 0, 0), Vec3(0, 0, 30)}) {
    Image<float> map = source.clone();
    for (int step = 0; step < 12; ++step) {
      map = resample(map, latlong, latlong, source.size(), rotation_from_degrees(axis));
    }
    const Errors e = compare(map, source, 0, Vec3::UnitZ());
    EXPECT_GT(e.psnr, 45) << "about " << axis.transpose();
    EXPECT_LT(std::abs(e.total), 1e-3) << "about " << axis.transpose();
  }
}

}  // namespace
}  // namespace hdr
