#include "libhdr/merge/merge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/response/expose.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

constexpr NoiseModel kNoNoise{1e12, 0};
constexpr double kSensitivity = 0.18;

Alignment registered(const Bracket& bracket) {
  Alignment alignment;
  alignment.frames.resize(bracket.shots.size());
  return alignment;
}

Photo shot_at(View<const float> scene, double ev, const Response& response, const NoiseModel& noise,
              std::uint64_t seed) {
  Exposure exposure;
  exposure.seconds = std::exp2(ev);
  Photo photo = expose(scene, exposure, {response, noise, kSensitivity}, seed);
  photo.path = "ev" + std::to_string(static_cast<int>(ev)) + ".png";
  return photo;
}

Bracket bracket_of(View<const float> scene, const std::vector<double>& evs, const Response& response,
                   const NoiseModel& noise = kNoNoise) {
  Bracket bracket;
  for (const double ev : evs) {
    bracket.shots.push_back(shot_at(scene, ev, response, noise, 10 + bracket.shots.size()));
    bracket.input_order.push_back(static_cast<int>(bracket.input_order.size()));
  }
  return bracket;
}

Image<float> patches(const std::vector<std::array<float, 3>>& colours) {
  Image<float> image(static_cast<int>(colours.size()), 1, 3);
  for (std::size_t x = 0; x < colours.size(); ++x)
    std::copy_n(colours[x].begin(), 3, image.pixel(static_cast<int>(x), 0));
  return image;
}

/// merge(), its map in the unit exp(g) / H whatever the middle shot.
Merged merge_per_exposure(const Bracket& bracket, const Alignment& alignment, const Response& response,
                          const MergeOptions& options = {}) {
  Merged merged = merge(bracket, alignment, response, options);
  for (int y = 0; y < merged.map.rgb.height(); ++y) {
    for (int k = 0; k < 3 * merged.map.rgb.width(); ++k) {
      merged.map.rgb.row(y)[k] /= static_cast<float>(merged.exposure_unit);
    }
  }
  return merged;
}

/// g(mid) = 0 leaves the scale free: radiance exp(g) / H of a scene value v is v * sensitivity / (exposure share of the
/// middle code).
double map_per_scene(const Response& response, int channel) {
  return kSensitivity * response.exposure(channel, std::ldexp(1.0, response.bits) - 1);
}

/// Median and 99th percentile of |log2(map / truth)|.
std::pair<double, double> errors(View<const float> map, View<const float> scene, const Response& response) {
  std::vector<double> all;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        all.push_back(std::abs(std::log2(map(x, y, c) / (scene(x, y, c) * map_per_scene(response, c)))));
      }
    }
  }
  std::sort(all.begin(), all.end());
  return {all[all.size() / 2], all[all.size() * 99 / 100]};
}

bool same_bytes(const Image<float>& a, const Image<float>& b) {
  for (int y = 0; y < a.height(); ++y) {
    if (std::memcmp(a.row(y), b.row(y), a.row_samples() * sizeof(float)) != 0) return false;
  }
  return true;
}

TEST(Merge, RecoversRadianceOverSixteenStops) {
  const Image<float> scene = test::test_scene(300, 200, 16, 4);
  for (const char* name : {"linear", "srgb", "gamma:2.2", "film"}) {
    for (const WeightKind weight : {WeightKind::kHat, WeightKind::kVariance}) {
      const Response response = *response_from_name(name, 8);
      const Bracket bracket = bracket_of(scene, {-12, -10, -8, -6, -4, -2, 0, 2, 4, 6, 8, 10, 12, 14}, response, {});
      const Merged merged = merge_per_exposure(bracket, registered(bracket), response, {weight});
      const auto [median, p99] = errors(merged.map.rgb, scene, response);
      EXPECT_LT(median, 0.02) << name;
      EXPECT_LT(p99, 0.1) << name;
      EXPECT_EQ(merged.clipped, 0);
    }
  }
}

// Inverse variance is the better weight when the noise is what it says.
TEST(Merge, VarianceWeightsBeatTheHatOnLosslessShots) {
  const Image<float> scene = test::test_scene(300, 200, 8, 5);
  const Response response = gamma_response(8, 2.2);
  const Bracket bracket = bracket_of(scene, {-4, -3, -2, -1, 0, 1, 2, 3, 4}, response, {});
  const auto hat =
      errors(merge_per_exposure(bracket, registered(bracket), response, {WeightKind::kHat}).map.rgb, scene, response);
  const auto automatic = errors(merge_per_exposure(bracket, registered(bracket), response).map.rgb, scene, response);
  EXPECT_LT(automatic.first, 0.8 * hat.first) << "auto chooses variance for lossless shots";
  EXPECT_LT(automatic.second, hat.second);
}

TEST(Merge, SixteenBitsResolveWhatEightCannot) {
  const Image<float> scene = test::test_scene(200, 150, 6, 6);
  const Response response = linear_response(16);
  const Bracket bracket = bracket_of(scene, {-4, -2, 0, 2}, response);
  const auto [median, p99] =
      errors(merge_per_exposure(bracket, registered(bracket), response).map.rgb, scene, response);
  EXPECT_LT(median, 1e-3);
  EXPECT_LT(p99, 0.01);
}

TEST(Merge, OneShotAloneIsItsLinearisation) {
  const Image<float> scene = patches({{0.5f, 1.0f, 2.0f}});
  const Response response = srgb_response(8);
  const Bracket bracket = bracket_of(scene, {0}, response);
  const Merged merged = merge_per_exposure(bracket, registered(bracket), response);
  const auto& codes = std::get<Image<std::uint8_t>>(bracket.shots[0].codes);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(merged.map.rgb(0, 0, c) / response.exposure(c, codes(0, 0, c)), 1, 1e-6);
  }
}

TEST(Merge, WhatClipsEverywhereIsNeutralAndNeverBelowSaturation) {
  const Response response = film_response(8);  // its channels saturate at different exp(g(255))
  const Image<float> scene = patches({{1, 1, 1}, {1e6f, 1e6f, 1e6f}, {1e6f, 0.1f, 0.1f}, {4.0f, 1e6f, 3.9f}});
  const Bracket bracket = bracket_of(scene, {0, 4, 8}, response);
  const Merged merged = merge_per_exposure(bracket, registered(bracket), response);
  const auto saturation = [&](int c) { return response.exposure(c, 255) * 0.99999; };  // shortest H = 1
  EXPECT_EQ(merged.clipped, 3);
  const float* sun = merged.map.rgb.pixel(1, 0);
  EXPECT_EQ(sun[0], sun[1]);
  EXPECT_EQ(sun[1], sun[2]);
  for (int c = 0; c < 3; ++c) {
    EXPECT_GE(sun[c], saturation(c));
    EXPECT_LE(sun[c], saturation(c) * 1.1) << "a bound, not an invention";
  }
  const float* red_lamp = merged.map.rgb.pixel(2, 0);
  EXPECT_GE(red_lamp[0], saturation(0));
  EXPECT_LT(red_lamp[1], 0.05 * red_lamp[0]) << "a red lamp stays red";
  const float* bright = merged.map.rgb.pixel(3, 0);
  EXPECT_GE(bright[1], std::max(bright[0], bright[2])) << "not magenta: the clipped green is the least of the three";
}

TEST(Merge, WhatIsBlackEverywhereIsSmallNeutralAndCounted) {
  const Response response = film_response(8);
  const Image<float> scene = patches({{0, 0, 0}, {1, 1, 0}, {1, 1, 1}});
  const Bracket bracket = bracket_of(scene, {-4, -2, 0}, response);
  const Merged merged = merge_per_exposure(bracket, registered(bracket), response);
  EXPECT_EQ(merged.dark, 2);
  EXPECT_EQ(merged.clipped, 0);
  const float* black = merged.map.rgb.pixel(0, 0);
  EXPECT_EQ(black[0], black[2]);
  for (int c = 0; c < 3; ++c) {
    EXPECT_GE(black[c], 0);
    EXPECT_LE(black[c], response.exposure(c, 0) * 1.00001) << "no more than the black of the longest shot";
  }
}

// Black in the short shot and clipped in the long one: the truth lies between.
TEST(Merge, AGapBetweenTwoShotsIsBridgedByTheMiddleOfItsBounds) {
  const Response response = linear_response(8);
  const float gap = 1e-3f;
  const Bracket bracket = bracket_of(patches({{gap, gap, gap}, {1e-5f, 1e-5f, 1e-5f}, {2, 2, 2}}), {0, 16}, response);
  const Merged merged = merge_per_exposure(bracket, registered(bracket), response);
  EXPECT_EQ(merged.clipped + merged.dark, 0);
  EXPECT_GT(merged.map.rgb(0, 0, 1), response.exposure(1, 255) / 65536);
  EXPECT_LT(merged.map.rgb(0, 0, 1), response.exposure(1, 1));
}

TEST(Merge, AClippedCodeCountsOnlyInTheShortestShotAndABlackOneOnlyInTheLongest) {
  const Response response = srgb_response(8);
  // Clipped in the two longer shots, measured in the shortest; black in the two shorter, measured in the longest.
  const Image<float> scene = patches({{3, 3, 3}, {0.0006f, 0.0006f, 0.0006f}});
  const Bracket bracket = bracket_of(scene, {0, 6, 8}, response);
  const Merged merged = merge_per_exposure(bracket, registered(bracket), response);
  for (int x = 0; x < 2; ++x) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(merged.map.rgb(x, 0, c) / (scene(x, 0, c) * map_per_scene(response, c)), 1, 0.03);
    }
  }
}

// A small sun in JPEGs: chroma subsampling pulls a channel below clipping in one of the long shots.
TEST(Merge, SmearInALongerJpegCannotUnclipTheSun) {
  const Response response = srgb_response(8);
  Bracket bracket = bracket_of(patches({{1e5f, 1e5f, 1e5f}, {1, 1, 1}}), {0, 3, 6}, response);
  for (Photo& photo : bracket.shots) photo.lossy = true;
  std::get<Image<std::uint8_t>>(bracket.shots[2].codes)(0, 0, 2) = 244;
  const Merged merged = merge_per_exposure(bracket, registered(bracket), response);
  EXPECT_EQ(merged.clipped, 1);
  EXPECT_GE(merged.map.rgb(0, 0, 2), response.exposure(2, 255) * 0.99999);
}

// Weights that follow the observed code would take read noise in a short exposure for a great radiance.
TEST(Merge, ReadNoiseInShortShotsDoesNotLiftTheDark) {
  const Response response = gamma_response(8, 2.2);
  Image<float> scene(200, 100, 3);
  for (int y = 0; y < 100; ++y) std::fill_n(scene.row(y), 600, 1e-3f);
  const Bracket bracket = bracket_of(scene, {-12, -10, -8, -6, -4, -2, 0, 2, 4, 6, 8}, response, NoiseModel{});
  for (const WeightKind weight : {WeightKind::kHat, WeightKind::kVariance}) {
    const Merged merged = merge_per_exposure(bracket, registered(bracket), response, {weight});
    EXPECT_LT(errors(merged.map.rgb, scene, response).second, 0.1);
  }
}

TEST(Merge, UselessShotsAreSkippedAndChangeNothing) {
  const Image<float> scene = test::test_scene(120, 80, 8, 9);
  const Response response = srgb_response(8);
  const Bracket useful = bracket_of(scene, {-4, -2, 0, 2}, response, {});
  Bracket padded;
  padded.shots.push_back(shot_at(scene, -30, response, kNoNoise, 1));
  for (const Photo& photo : bracket_of(scene, {-4, -2, 0, 2}, response, {}).shots) {
    Photo copy;
    copy.exposure = photo.exposure;
    copy.codes = std::get<Image<std::uint8_t>>(photo.codes).clone();
    padded.shots.push_back(std::move(copy));
  }
  padded.shots.push_back(shot_at(scene, 30, response, kNoNoise, 1));
  const Merged plain = merge_per_exposure(useful, registered(useful), response);
  const Merged more = merge_per_exposure(padded, registered(padded), response);
  ASSERT_EQ(more.frames.size(), 6u);
  EXPECT_FALSE(more.frames[0].used);
  EXPECT_EQ(more.frames[0].skipped, "all black");
  EXPECT_EQ(more.frames[5].skipped, "all clipped");
  EXPECT_TRUE(more.frames[2].used);
  EXPECT_TRUE(same_bytes(plain.map.rgb, more.map.rgb));
  EXPECT_EQ(plain.clipped, more.clipped);
}

TEST(Merge, AllBlackAndAllWhiteBracketsGiveTheirBounds) {
  const Response response = srgb_response(8);
  const Image<float> scene = patches({{1, 1, 1}, {1, 1, 1}});
  const Bracket black = bracket_of(scene, {-30, -28}, response), white = bracket_of(scene, {28, 30}, response);
  const Merged dark = merge_per_exposure(black, registered(black), response);
  EXPECT_EQ(dark.dark, 2);
  const Merged clipped = merge_per_exposure(white, registered(white), response);
  EXPECT_EQ(clipped.clipped, 2);
  EXPECT_NEAR(clipped.map.rgb(1, 0, 0) * std::exp2(28) / response.exposure(0, 255), 1, 1e-5);
}

TEST(Merge, TheBytesDoNotDependOnThreads) {
  const Image<float> scene = test::test_scene(200, 150, 14, 3);
  const Response response = film_response(8);
  const Bracket bracket = bracket_of(scene, {-4, -2, 0, 2}, response, {});
  Alignment alignment = registered(bracket);
  alignment.frames[1].ref_from_photo(0, 2) = 1.5;
  set_threads(1);
  const Merged one = merge_per_exposure(bracket, alignment, response);
  set_threads(2);
  const Merged two = merge_per_exposure(bracket, alignment, response);
  set_threads(0);
  EXPECT_TRUE(same_bytes(one.map.rgb, two.map.rgb));
  EXPECT_EQ(one.clipped, two.clipped);
  EXPECT_EQ(one.stops, two.stops);
}

TEST(Merge, MovedShotsAreBroughtBackToTheReference) {
  const Image<float> scene = test::test_scene(240, 160, 6, 8);
  const Response response = srgb_response(8);
  Bracket bracket = bracket_of(scene, {-6, -4, -2, 0, 2, 4}, response);
  Mat3 shift = Mat3::Identity();  // photo pixel p shows scene pixel p + (7, -4)
  shift(0, 2) = 7;
  shift(1, 2) = -4;
  bracket.shots[4] = shot_at(shake(scene, shift), 2, response, kNoNoise, 1);
  Alignment alignment = registered(bracket);
  alignment.frames[4].ref_from_photo = shift;
  const Merged merged = merge_per_exposure(bracket, alignment, response);
  const auto [median, p99] = errors(merged.map.rgb, scene, response);
  EXPECT_LT(median, 0.01);
  EXPECT_LT(p99, 0.06);
  EXPECT_NEAR(merged.map.rgb(2, 100, 1) / (scene(2, 100, 1) * map_per_scene(response, 1)), 1, 0.05)
      << "left of the moved shot only the others count";
}

TEST(Merge, RadianceOverTwelveOrdersOfMagnitudeStaysFinite) {
  std::vector<std::array<float, 3>> colours;
  for (int e = -20; e <= 20; ++e) colours.push_back({std::exp2f(static_cast<float>(e)), 1e-30f, INFINITY});
  const Image<float> scene = patches(colours);
  const Response response = film_response(8);
  const Bracket bracket = bracket_of(scene, {-18, -15, -12, -9, -6, -3, 0, 3, 6, 9, 12, 15, 18}, response, {});
  const Merged merged = merge_per_exposure(bracket, registered(bracket), response);
  for (int x = 0; x < scene.width(); ++x) {
    for (int c = 0; c < 3; ++c) {
      ASSERT_TRUE(std::isfinite(merged.map.rgb(x, 0, c)) && merged.map.rgb(x, 0, c) >= 0);
    }
    EXPECT_NEAR(std::log2(merged.map.rgb(x, 0, 0) / (scene(x, 0, 0) * map_per_scene(response, 0))), 0, 0.3) << x;
  }
}

TEST(Merge, StopsAreTheRangeOfTheScene) {
  Image<float> ramp(1000, 20, 3);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 1000; ++x) {
      std::fill_n(ramp.pixel(x, y), 3, std::exp2f(10.0f * (static_cast<float>(x) / 999 - 0.5f)));
    }
  }
  const Response response = srgb_response(8);
  const Bracket bracket = bracket_of(ramp, {-6, -4, -2, 0, 2, 4}, response);
  EXPECT_NEAR(merge_per_exposure(bracket, registered(bracket), response).stops, 10, 0.1);
}

TEST(Merge, RadianceOneIsTheMiddleCodeOfTheMiddleShot) {
  const Response response = gamma_response(8, 2);
  const auto level = static_cast<float>(std::pow(128 / 255.0, 2) / kSensitivity);
  const Bracket bracket = bracket_of(patches({{level / 16, level / 16, level / 16}}), {2, 4, 6}, response);
  const Merged merged = merge(bracket, registered(bracket), response);
  EXPECT_NEAR(merged.exposure_unit, 16, 1e-12);
  EXPECT_NEAR(merged.map.rgb(0, 0, 0), 1, 0.01);
}

TEST(Merge, AResponseOfAnotherDepthIsAnError) {
  const Bracket bracket = bracket_of(patches({{1, 1, 1}}), {0, 1}, srgb_response(8));
  try {
    merge_per_exposure(bracket, registered(bracket), srgb_response(16));
    FAIL() << "an 8-bit shot was merged with a 16-bit response";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("ev0.png: has 8-bit codes"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace hdr
