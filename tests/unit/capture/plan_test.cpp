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

}  // namespace
}  // namespace hdr
