#include "libhdr/response/estimate_noise.h"

#include <gtest/gtest.h>

#include "libhdr/core/parallel.h"
#include "tests/unit/response/simulated.h"

namespace hdr {
namespace {

using test::simulate;
using test::Simulation;

struct Camera {
  const char* response;
  int bits;
  double full_well, read_noise;
  std::uint64_t seed;
};

void PrintTo(const Camera& c, std::ostream* out) {
  *out << c.response << ", " << c.bits << " bits, full well " << c.full_well << ", read noise " << c.read_noise;
}

class EstimateNoise : public testing::TestWithParam<Camera> {};

// What matters is the variance that the model predicts at each level: within 12 % of its deviation.
TEST_P(EstimateNoise, FindsTheNoiseOfTheCameraThatTookTheShots) {
  const Camera camera = GetParam();
  const Response truth = *response_from_name(camera.response, camera.bits);
  Simulation simulation;
  simulation.evs = {-4, -3, -2, -1, 0, 1, 2, 3, 4};
  simulation.noise = {camera.full_well, camera.read_noise};
  simulation.seed = camera.seed;
  const auto [found, outliers] = estimate_noise(simulate(truth, simulation), {}, truth);
  EXPECT_LT(outliers, 0.004) << "nothing but noise";
  for (const NoiseModel& noise : found) {
    EXPECT_EQ(noise.code_noise, 0) << "lossless codes are only rounded";
    for (const double level : {0.003, 0.03, 0.3, 0.9}) {
      EXPECT_NEAR(noise.stddev(level) / simulation.noise.stddev(level), 1, 0.12)
          << "at level " << level << ": full well " << noise.full_well << ", read noise " << noise.read_noise;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, EstimateNoise,
                         testing::Values(Camera{"linear", 16, 30000, 5, 1}, Camera{"linear", 16, 8000, 20, 2},
                                         Camera{"linear", 14, 80000, 3, 3}, Camera{"srgb", 8, 30000, 5, 4},
                                         Camera{"gamma:2.2", 8, 12000, 12, 5}, Camera{"film", 8, 20000, 8, 6},
                                         Camera{"film", 16, 5000, 30, 7}));

TEST(EstimateNoise, WithoutOverlapTheUsualCameraRemains) {
  Simulation simulation;
  simulation.evs = {0};
  const NoiseModel usual;
  const Noise found = estimate_noise(simulate(srgb_response(8), simulation), {}, srgb_response(8)).noise;
  for (const NoiseModel& noise : found) {
    EXPECT_NEAR(noise.full_well / usual.full_well, 1, 1e-6);
    EXPECT_NEAR(noise.read_noise / usual.read_noise, 1, 1e-6);
  }
}

// A tenth of the picture shows something else in every shot.
TEST(EstimateNoise, IsNotMovedByWhatMoves) {
  Simulation simulation;
  simulation.evs = {-3, -2, -1, 0, 1, 2, 3};
  Bracket bracket = simulate(srgb_response(8), simulation);
  for (std::size_t j = 0; j < bracket.shots.size(); ++j) {
    auto& codes = std::get<Image<std::uint8_t>>(bracket.shots[j].codes);
    for (int y = 0; y < codes.height(); ++y) {
      std::fill_n(codes.pixel(45 * static_cast<int>(j), y), 3 * 45, static_cast<std::uint8_t>(60 + 10 * j));
    }
  }
  const auto [found, outliers] = estimate_noise(bracket, {}, srgb_response(8));
  EXPECT_GT(outliers, 0.02);
  for (const NoiseModel& noise : found) EXPECT_NEAR(noise.stddev(0.2) / simulation.noise.stddev(0.2), 1, 0.3);
}

TEST(EstimateNoise, IsTheSameOnAnyNumberOfThreads) {
  const Bracket bracket = simulate(srgb_response(8), {});
  set_threads(1);
  const Noise one = estimate_noise(bracket, {}, srgb_response(8)).noise;
  set_threads(2);
  const Noise two = estimate_noise(bracket, {}, srgb_response(8)).noise;
  set_threads(0);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(one[c].full_well, two[c].full_well);
    EXPECT_EQ(one[c].read_noise, two[c].read_noise);
  }
}

}  // namespace
}  // namespace hdr
