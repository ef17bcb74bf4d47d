#include "capture/plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "capture/shoot.h"
#include "libhdr/core/random.h"
#include "tests/support/support.h"
#include "tests/unit/capture/cover.h"
#include "tests/unit/capture/witness.h"

namespace hdr {
namespace {

/// A scene, a device and its faults, all at random.
struct Case {
  double stops = 0;
  Image<float> scene;
  VirtualCameraOptions options;
  bool response_known = false;
  std::string text;
};

Image<float> random_scene(Random& random, double stops, bool sun, std::uint64_t seed) {
  Image<float> scene = test::test_scene(96, 72, stops, seed);
  if (sun) {
    const double bright = std::exp2(0.5 * stops + 3 + 4 * random.uniform());
    for (int y = 4; y < 13; ++y) {
      for (int x = 60; x < 70; ++x) {
        for (int c = 0; c < 3; ++c) scene(x, y, c) = static_cast<float>(bright);
      }
    }
  }
  return scene;
}

Case random_case(std::uint64_t seed) {
  Random random(seed, 0xca5e);
  Case c;
  c.stops = 4 + 18 * random.uniform();
  VirtualCameraOptions& o = c.options;
  const char* const responses[] = {"srgb", "gamma:2.2", "film", "linear"};
  o.response = responses[random.bits() % 4];
  o.latency = static_cast<int>(random.bits() % 9);
  o.metadata = random.uniform() < 0.4;
  o.seed = seed;
  // A lamp or a sun, and nothing between it and the rest. No exposure shows both in the four stops of 8 linear bits:
  // how far apart two exposures are that show only one each, only the device can say.
  const bool sun = random.uniform() < 0.3 && (o.metadata || o.response != "linear");
  c.scene = random_scene(random, c.stops, sun, seed);
  const bool steps = random.uniform() < 0.3;
  o.seconds = steps ? Range{1e-4, 1, 1e-4} : Range{1e-5, std::exp2(-2 + 5 * random.uniform()), 0};
  if (random.uniform() < 0.3) o.gain = {1, 16, 0};
  c.response_known = random.uniform() < 0.5;
  std::ostringstream text;
  text << "seed " << seed << ": " << c.stops << " stops, " << o.response << ", latency " << o.latency << ", metadata "
       << o.metadata << ", " << o.seconds.min << ".." << o.seconds.max << " s, gain " << o.gain.max << ", known "
       << c.response_known;
  double* const faults[] = {&o.faults.dropped, &o.faults.damaged, &o.faults.cut, &o.faults.torn};
  const auto fault = random.bits() % 8;
  if (fault < 3 || (fault == 3 && !(o.metadata && o.seconds.max > 1))) {  // nobody looks twice at what takes that long
    *faults[fault] = 0.1;
    text << ", fault " << fault;
  } else if (fault == 4 && !o.metadata) {
    o.faults.clamp_seconds = 1.0 / 30 * std::exp2(3 * random.uniform() - 1);
    text << ", clamp " << o.faults.clamp_seconds;
  }
  c.text = text.str();
  return c;
}

/// Codes 16 to 250 of 255, as levels of light; the three colours of a film differ, and a sample may be of any.
test::Levels levels_of(const std::string& name) {
  const Response response = *response_from_name(name, 8);
  test::Levels levels{0, 1};
  for (int c = 0; c < 3; ++c) {
    const double full = response.exposure(c, 255);
    levels.floor = std::max(levels.floor, response.exposure(c, 16) / full);
    levels.ceiling = std::min(levels.ceiling, response.exposure(c, 250) / full);
  }
  return levels;
}

TEST(Plan, CoversWhatTheDeviceCanInAtMostOneShotMoreThanTheFewest) {
  constexpr std::uint64_t kScenes = 200;
  int worst = 0, tried = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    Case c = random_case(seed);
    const test::Levels levels = levels_of(c.options.response);
    Exposure metered = c.options.optics;
    metered.seconds = 1.0 / 60;
    // Of full well, for unit radiance in one second.
    const double sensitivity = metered_sensitivity(c.scene, metered, c.options.level) * 60 * metered.relative().value();
    const double longest_seconds = std::min(c.options.seconds.max, 0.88 * c.options.faults.clamp_seconds);
    const double shortest = c.options.seconds.min, longest = longest_seconds * c.options.gain.max;
    const std::vector<double> light = test::samples_to_show(c.scene, sensitivity, levels, shortest, longest);
    std::vector<double> candidates;
    for (double h = shortest; h < longest; h *= std::exp2(1.0 / 6)) candidates.push_back(h);
    candidates.push_back(longest);

    test::Witness camera("virtual:test", c.scene.clone(), c.options);
    BracketRequest request;
    request.response_known = c.response_known;
    Take take;
    try {
      take = shoot(camera, request);
    } catch (const Error& error) {
      ADD_FAILURE() << c.text << ": " << error.what();
      continue;
    }
    std::vector<double> exposures;
    for (const Frame& frame : take.frames) {
      exposures.push_back(camera.truth(frame).total());
      // A clamp just below what was asked is within what brightness tells.
      const double told = std::isfinite(c.options.faults.clamp_seconds) ? 0.15 : 0.01;
      EXPECT_NEAR(std::log2(frame.exposure->total() / exposures.back()), 0, told) << c.text;
    }
    std::string shots;
    for (const PlannedShot& shot : take.plan.shots) {
      shots += "\n    " + std::to_string(shot.setting.seconds) + " s, gain " + std::to_string(shot.setting.gain) +
               ": " + shot.reason;
    }
    const int fewest = test::fewest_by_reach(light, candidates, levels);
    if (fewest < 4) {
      EXPECT_EQ(test::fewest_by_trying(light, candidates, levels), fewest) << c.text;
      ++tried;
    }
    const int more = static_cast<int>(take.frames.size()) - std::max(fewest, 1);
    worst = std::max(worst, more);
    EXPECT_LE(more, 1) << c.text << "\n  " << fewest << " are enough; planned:" << shots
                       << test::joined(take.plan.notes);
    EXPECT_LE(test::share_missed(light, exposures, levels), 0.001)
        << c.text << "\n  planned:" << shots << test::joined(take.plan.notes) << test::joined(take.warnings);
  }
  EXPECT_GE(tried, 50) << "the search by trying all sets checked too few cases";
}

/// Light that is spread evenly over these stops, about an exposure of 1 for the middle of the window.
LightLevels even_light(double stops) {
  LightLevels light;
  for (int k = 0; k < kLightLevels; ++k) {
    light.ln_light.push_back(-std::log(10) + std::log(2) * stops * ((k + 0.5) / kLightLevels - 0.5));
  }
  return light;
}
const Window kSixStops{std::log(0.01), std::log(0.64)};

Capabilities device(const Range& seconds, const Range& gain = {1, 1, 0}) {
  Capabilities limits;
  limits.seconds = seconds;
  limits.gain = gain;
  return limits;
}

BracketRequest known() {
  BracketRequest request;
  request.response_known = true;
  return request;
}

TEST(Plan, OneShotWhereOneIsEnoughAndOneMoreWhereTheResponseIsNotKnown) {
  const Capabilities limits = device({1e-6, 1e6, 0});
  EXPECT_EQ(plan_auto(even_light(4), kSixStops, {}, limits, known()).shots.size(), 1u);
  const Plan two = plan_auto(even_light(4), kSixStops, {}, limits, {});
  ASSERT_EQ(two.shots.size(), 2u);
  const double apart = std::log2(two.shots[1].setting.total() / two.shots[0].setting.total());
  EXPECT_NEAR(apart, 8.0 / 3, 1e-6) << "off a grid of whole stops";
  const Plan four = plan_auto(even_light(16), kSixStops, {}, limits, {});
  ASSERT_EQ(four.shots.size(), 4u);
  std::vector<double> steps;
  for (std::size_t k = 1; k < 4; ++k) {
    steps.push_back(std::log2(four.shots[k].setting.total() / four.shots[k - 1].setting.total()));
  }
  const auto [least, most] = std::minmax_element(steps.begin(), steps.end());
  EXPECT_GT(*most - *least, 0.5) << "a uniform grid cannot fix the response";
}

TEST(Plan, SpendsNoShotOnAnEmptyRange) {
  LightLevels light = even_light(3);
  for (std::size_t k = light.ln_light.size() / 2; k < light.ln_light.size(); ++k) light.ln_light[k] += 12 * std::log(2);
  const Plan plan = plan_auto(light, kSixStops, {}, device({1e-6, 1e6, 0}), known());
  EXPECT_EQ(plan.shots.size(), 2u) << "a room and a sun";
}

TEST(Plan, StandsAtAProbeThatIsThereAlready) {
  const Capabilities limits = device({1e-6, 1e6, 0});
  const Plan free = plan_auto(even_light(4), kSixStops, {}, limits, known());
  const double total = free.shots[0].setting.total() * 1.4;
  const Plan there = plan_auto(even_light(4), kSixStops, {{total, nullptr}}, limits, known());
  ASSERT_EQ(there.shots.size(), 1u);
  EXPECT_DOUBLE_EQ(there.shots[0].setting.total(), total);
}

TEST(Plan, SaysWhichEndIsLost) {
  LightLevels light = even_light(20);
  const Plan plan = plan_auto(light, kSixStops, {}, device({0.1, 10, 0}), known());
  EXPECT_TRUE(plan.bright_end_lost);
  EXPECT_TRUE(plan.dark_end_lost);
  ASSERT_EQ(plan.notes.size(), 2u);
  EXPECT_NE(plan.notes[0].find("bright end is lost"), std::string::npos);
  const Plan whole = plan_auto(light, kSixStops, {}, device({1e-6, 1e6, 0}), known());
  EXPECT_FALSE(whole.bright_end_lost || whole.dark_end_lost) << test::joined(whole.notes);
}

TEST(Plan, GainIsForWhatTimeCannotDo) {
  const Capabilities limits = device({1e-3, 0.1, 0}, {1, 8, 0});
  EXPECT_EQ(setting_near(0.05, limits), (ExposureSetting{0.05, 1}));
  EXPECT_EQ(setting_near(0.4, limits), (ExposureSetting{0.1, 4}));
  EXPECT_EQ(setting_near(100, limits), (ExposureSetting{0.1, 8}));
  EXPECT_EQ(setting_near(1e-9, limits), (ExposureSetting{1e-3, 1}));
}

TEST(Plan, TimesAreTheDevicesAndTheLamps) {
  const Capabilities limits = device({1e-4, 1, 1e-4});
  for (const double mains : {50.0, 60.0}) {
    const double period = 0.5 / mains;
    for (double total = 1e-4; total < 1; total *= 1.17) {
      const ExposureSetting below = setting_at_most(total, limits, mains),
                            above = setting_at_least(total, limits, mains);
      for (const ExposureSetting& setting : {below, above}) {
        EXPECT_NEAR(limits.seconds.snap(setting.seconds), setting.seconds, 1e-12);
        const double periods = setting.seconds / period;
        if (setting.seconds > period) {
          EXPECT_NEAR(periods, std::round(periods), 0.5e-4 / period + 1e-9) << total;
        }
      }
      EXPECT_LE(below.seconds, total + 0.51e-4);
      EXPECT_GE(above.seconds, std::min(total, 1 - period) - 0.51e-4);
    }
  }
}

TEST(Plan, GridsAndTimesAreKeptAsAsked) {
  BracketRequest request;
  request.grid = BracketRequest::Grid{2, 5};
  const LightLevels light = even_light(6);
  const Plan grid = plan_grid(light, device({1e-6, 1e6, 0}), request);
  ASSERT_EQ(grid.shots.size(), 5u);
  EXPECT_NEAR(grid.shots[2].setting.total(), 1.8, 0.01) << "18 % of full well at the median, a tenth";
  EXPECT_NEAR(grid.shots[4].setting.total() / grid.shots[3].setting.total(), 4, 1e-9);
  EXPECT_EQ(plan_grid(light, device({1, 3, 0}), request).shots.size(), 1u) << "the others are beyond the device";
  BracketRequest times;
  times.times = {0.25, 0.004, 50};
  const Plan given = plan_times(device({1e-3, 2, 0}), times);
  ASSERT_EQ(given.shots.size(), 3u);
  EXPECT_DOUBLE_EQ(given.shots[0].setting.seconds, 0.25);
  EXPECT_DOUBLE_EQ(given.shots[2].setting.seconds, 2);
  EXPECT_EQ(given.notes.size(), 1u);
  times.times = {0.005, 0.01, 0.0167, 0.02};
  times.mains_hz = 50;
  const Plan lamps = plan_times(device({1e-3, 2, 0}), times);
  ASSERT_EQ(lamps.notes.size(), 1u) << "shorter than a period, nothing helps" << test::joined(lamps.notes);
  EXPECT_NE(lamps.notes[0].find("0.0167 s"), std::string::npos) << lamps.notes[0];
  EXPECT_DOUBLE_EQ(lamps.shots[2].setting.seconds, 0.0167);
}

}  // namespace
}  // namespace hdr
