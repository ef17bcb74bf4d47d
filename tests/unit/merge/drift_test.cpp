// Light that changes from shot to shot.
#include "libhdr/merge/drift.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/random.h"
#include "libhdr/merge/merge.h"
#include "tests/support/movers.h"

namespace hdr {
namespace {

struct Drifting {
  Bracket bracket;
  Alignment alignment;
  Response response = srgb_response(8);
  Image<float> scene;
  std::vector<double> ln_gain;  ///< mean zero, no slope against ln exposure
};

/// Without their mean and their slope against place, over the shots of `places` alone; the others become 0.
std::vector<double> gauged(const std::vector<double>& values, const std::vector<std::size_t>& places) {
  double place = 0, mean = 0, slope = 0, squares = 0;
  for (const std::size_t k : places) {
    place += static_cast<double>(k) / static_cast<double>(places.size());
    mean += values[k] / static_cast<double>(places.size());
  }
  for (const std::size_t k : places) {
    slope += (static_cast<double>(k) - place) * (values[k] - mean);
    squares += std::pow(static_cast<double>(k) - place, 2);
  }
  std::vector<double> out(values.size());
  for (const std::size_t k : places) out[k] = values[k] - mean - (static_cast<double>(k) - place) * slope / squares;
  return out;
}

/// Shots two stops apart, in light that differs by `size` (ln).
Drifting drifting(std::uint64_t seed, int shots, double size, bool lossy) {
  Drifting made;
  made.scene = test::test_scene(240, 160, 7, seed);
  Random random(seed, 5);
  std::vector<double> values;
  std::vector<std::size_t> all;
  for (int k = 0; k < shots; ++k) {
    values.push_back(size * random.normal());
    all.push_back(static_cast<std::size_t>(k));
  }
  made.ln_gain = gauged(values, all);
  for (int k = 0; k < shots; ++k) {
    Exposure exposure;
    exposure.seconds = std::exp2(2 * (k - 0.5 * (shots - 1)));
    const Sensor sensor{made.response, NoiseModel{}, 0.18 * std::exp(made.ln_gain[static_cast<std::size_t>(k)])};
    made.bracket.shots.push_back(expose(made.scene, exposure, sensor, 100 * seed + static_cast<std::uint64_t>(k)));
    made.bracket.shots.back().lossy = lossy;
    made.bracket.input_order.push_back(k);
  }
  made.alignment = no_alignment(made.bracket);
  return made;
}

TEST(Drift, GainsComeBackWithinTheirDeviation) {
  double squares = 0, measured = 0, shots = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Drifting made = drifting(seed, 4 + static_cast<int>(seed % 4), 0.1, seed % 2);
    const std::vector<FrameGain> gains = estimate_drift(made.bracket, made.alignment, made.response);
    std::vector<std::size_t> known;
    for (std::size_t k = 0; k < gains.size(); ++k) {
      if (gains[k].deviation) known.push_back(k);
      EXPECT_EQ(gains[k].unknown.empty(), gains[k].deviation.has_value()) << "seed " << seed << ", shot " << k;
    }
    ASSERT_GE(known.size(), 3u) << seed;
    // A shot that clips almost throughout says nothing, and then the others have the gauge among themselves.
    const std::vector<double> truth = gauged(made.ln_gain, known);
    for (std::size_t k = 0; k < gains.size(); ++k) {
      EXPECT_NEAR(std::log(gains[k].gain), truth[k], 0.01) << "seed " << seed << ", shot " << k;
      if (gains[k].deviation) squares += std::pow((std::log(gains[k].gain) - truth[k]) / *gains[k].deviation, 2);
    }
    measured += static_cast<double>(known.size());
    shots += static_cast<double>(gains.size());
  }
  EXPECT_LT(std::sqrt(squares / measured), 1.5) << "errors in units of the deviation that was said";
  EXPECT_GT(std::sqrt(squares / measured), 0.3) << "nor is more doubt said than there is";
  EXPECT_GE(measured / shots, 0.9) << "shots that were measured";
}

TEST(Drift, AShotThatSharesNothingSaysSo) {
  const std::size_t last = 4;
  Drifting made = drifting(21, 5, 0.1, false);
  // Two hundred times more light than its label: white all over.
  const Sensor sensor{made.response, NoiseModel{}, 0.18 * 200};
  made.bracket.shots[last] = expose(made.scene, made.bracket.shots[last].exposure, sensor, 1);
  const std::vector<FrameGain> gains = estimate_drift(made.bracket, made.alignment, made.response);
  EXPECT_EQ(gains[last].gain, 1);
  EXPECT_FALSE(gains[last].deviation.has_value());
  EXPECT_NE(gains[last].unknown.find("well-exposed"), std::string::npos) << gains[last].unknown;
  const std::vector<double> truth = gauged(made.ln_gain, {0, 1, 2, 3});
  for (std::size_t k = 0; k < last; ++k) EXPECT_NEAR(std::log(gains[k].gain), truth[k], 0.01) << k;
  // One that the merge leaves out says that instead.
  const std::vector<FrameGain> fewer =
      estimate_drift(made.bracket, made.alignment, made.response, {false, false, false, false, true});
  EXPECT_EQ(fewer[last].unknown, "left out of the merge");
  EXPECT_EQ(fewer[0].gain, gains[0].gain);
}

TEST(Drift, SteadyLightHasGainsOfOne) {
  for (std::uint64_t seed = 11; seed <= 14; ++seed) {
    const Drifting made = drifting(seed, 5, 0, false);
    for (const FrameGain& gain : estimate_drift(made.bracket, made.alignment, made.response)) {
      EXPECT_NEAR(gain.gain, 1, 0.006) << seed;
    }
  }
}

TEST(Drift, WhatCannotBeToldIsOneAndWithoutADeviation) {
  Drifting made = drifting(3, 2, 0.2, false);
  for (const FrameGain& gain : estimate_drift(made.bracket, made.alignment, made.response)) {
    EXPECT_EQ(gain.gain, 1) << "of two shots it could be the response";
    EXPECT_FALSE(gain.deviation.has_value());
    EXPECT_NE(gain.unknown.find("only two"), std::string::npos) << gain.unknown;
  }
}

TEST(Drift, AThingThatMovesChangesLittle) {
  const test::MoverPlan plan;
  const test::MovingScene scene = test::moving_scene(plan);
  for (const FrameGain& gain : estimate_drift(scene.moving, no_alignment(scene.moving), plan.response)) {
    EXPECT_NEAR(gain.gain, 1, 0.015);
  }
}

TEST(Drift, AMergeThatKnowsItIsCloserToTheScene) {
  const Drifting made = drifting(5, 6, 0.12, false);
  const auto spread = [&](bool drift) {
    MergeOptions options;
    options.drift = drift;
    const Merged merged = merge(made.bracket, made.alignment, made.response, options);
    EXPECT_EQ(merged.frames[1].gain.deviation.has_value(), drift);
    double sum = 0, squares = 0, count = 0;
    for (int y = 0; y < made.scene.height(); ++y) {
      for (int x = 0; x < made.scene.width(); ++x) {
        const double ln = std::log(merged.map.rgb(x, y, 1) / made.scene(x, y, 1));
        sum += ln;
        squares += ln * ln;
        ++count;
      }
    }
    return std::sqrt(squares / count - sum * sum / (count * count));
  };
  EXPECT_LT(spread(true), 0.6 * spread(false));
}

}  // namespace
}  // namespace hdr
