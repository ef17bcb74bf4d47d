// Maximum likelihood: as good as any estimate can be, and its standard deviation right. The truth is known: expose().
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libhdr/merge/merge.h"
#include "libhdr/response/expose.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

struct Camera {
  const char* response;
  int bits;
  double full_well, read_noise, step_ev;
  int shots;
  std::uint64_t seed;
};

void PrintTo(const Camera& c, std::ostream* out) {
  *out << c.response << ", " << c.bits << " bits, full well " << c.full_well << ", read noise " << c.read_noise << ", "
       << c.shots << " shots " << c.step_ev << " EV apart";
}

struct Simulated {
  Bracket bracket;
  Response response;
  NoiseModel noise;
  std::vector<double> exposures;  ///< level of full well that radiance 1 gives
};

Simulated photograph(const Camera& camera, View<const float> scene) {
  Simulated s{{}, *response_from_name(camera.response, camera.bits), {camera.full_well, camera.read_noise}, {}};
  for (int j = 0; j < camera.shots; ++j) {
    s.exposures.push_back(std::exp2(camera.step_ev * (j - 0.5 * (camera.shots - 1))));
    Exposure exposure;
    exposure.seconds = s.exposures.back();
    s.bracket.shots.push_back(expose(scene, exposure, {s.response, s.noise, 1.0}, camera.seed * 100 + j));
    s.bracket.input_order.push_back(j);
  }
  return s;
}

/// merge() in units of the scene.
Merged merge_in_scene_units(const Simulated& s, const MergeOptions& options) {
  Merged merged = merge(s.bracket, no_alignment(s.bracket), s.response, options);
  const double max_code = std::ldexp(1.0, s.response.bits) - 1;
  for (int y = 0; y < merged.map.rgb.height(); ++y) {
    for (int x = 0; x < merged.map.rgb.width(); ++x) {
      for (int c = 0; c < 3; ++c) {
        const auto unit = static_cast<float>(merged.exposure_unit * s.response.exposure(c, max_code));
        merged.map.rgb(x, y, c) /= unit;
        if (!merged.map.stddev.empty()) merged.map.stddev(x, y, c) /= unit;
      }
    }
  }
  return merged;
}

MergeOptions known_noise(const Simulated& s) {
  MergeOptions options;
  options.noise = Noise{s.noise, s.noise, s.noise};
  options.uncertainty = true;
  return options;
}

class Likelihood : public testing::TestWithParam<Camera> {};

/// Row y of the scene has radiance radiances[y] throughout.
Image<float> steps(const std::vector<double>& radiances, int width) {
  Image<float> scene(width, static_cast<int>(radiances.size()), 3);
  for (int y = 0; y < scene.height(); ++y) {
    std::fill_n(scene.row(y), 3 * width, static_cast<float>(radiances[static_cast<std::size_t>(y)]));
  }
  return scene;
}

/// Cramer-Rao: no unbiased estimate has less variance than 1 / sum of H^2 / variance over the shots that do not clip.
double cramer_rao_bound(const Simulated& s, double radiance) {
  double information = 0;
  const double rounding = 1 / (std::ldexp(1.0, s.response.bits) - 1);  // of a linear curve
  for (const double H : s.exposures) {
    const double level = radiance * H, sensor = s.noise.stddev(level);
    if (level < 1) information += H * H / (sensor * sensor + rounding * rounding / 12);
  }
  return 1 / information;
}

/// Does noise decide whether a shot clips? There the bound cannot be reached: it counts the whole shot, of which a share
/// of the codes says only "clipped".
bool at_the_edge_of_clipping(const Simulated& s, double radiance) {
  return std::any_of(s.exposures.begin(), s.exposures.end(), [&](double H) {
    return std::abs(radiance * H - 1) < 3.5 * s.noise.stddev(radiance * H);
  });
}

struct RowErrors {
  double squares = 0;  ///< mean squared error
  double bias = 0;
};

RowErrors errors_of_row(const Merged& merged, int y, double truth) {
  RowErrors e;
  const int samples = 3 * merged.map.rgb.width();
  for (int k = 0; k < samples; ++k) {
    const double error = merged.map.rgb.row(y)[k] - truth;
    e.squares += error * error / samples;
    e.bias += error / samples;
  }
  return e;
}

// From the noise floor of the longest shot to what nearly saturates the shortest, and just under clipping of each shot.
std::vector<double> radiances_for(const Camera& camera) {
  std::vector<double> radiances;
  const double longest = std::exp2(camera.step_ev * 0.5 * (camera.shots - 1));
  const double floor = 6 * camera.read_noise / camera.full_well / longest;
  for (double radiance = floor; radiance < 0.9 * longest; radiance *= 1.19) radiances.push_back(radiance);
  for (int j = 0; j < camera.shots; ++j) {
    const double H = std::exp2(camera.step_ev * (j - 0.5 * (camera.shots - 1)));
    for (const double level : {0.93, 0.97, 0.985}) radiances.push_back(level / H);
  }
  return radiances;
}

TEST_P(Likelihood, ReachesTheCramerRaoBoundAtEveryLevel) {
  const Camera camera = GetParam();
  const Image<float> scene = steps(radiances_for(camera), 1000);
  const Simulated s = photograph(camera, scene);
  const Merged merged = merge_in_scene_units(s, known_noise(s));
  double mean_ratio = 0;
  int edges = 0;
  for (int y = 0; y < scene.height(); ++y) {
    const double truth = scene(0, y, 0), bound = cramer_rao_bound(s, truth);
    const RowErrors e = errors_of_row(merged, y, truth);
    mean_ratio += e.squares / bound / scene.height();
    const bool edge = at_the_edge_of_clipping(s, truth);
    edges += edge;
    // 3000 samples: the variance is known within 2.6 %, the mean within .018 deviations.
    EXPECT_LT(e.squares / bound, edge ? 2.5 : 1.15) << "at radiance " << truth;
    EXPECT_LT(std::abs(e.bias) / std::sqrt(bound), edge ? 0.2 : 0.08) << "at radiance " << truth;
  }
  EXPECT_LT(edges, scene.height() / 2);
  EXPECT_LT(mean_ratio, 1.15) << "edges of clipping included";
}

// The same with the noise measured from the shots themselves.
TEST_P(Likelihood, NeedsNotBeToldTheNoise) {
  Camera camera = GetParam();
  camera.seed += 1000;
  const Image<float> scene = test::test_scene(400, 300, 8, camera.seed);
  const Simulated s = photograph(camera, scene);
  const Merged merged = merge_in_scene_units(s, {});
  double ratio = 0, count = 0;
  for (int y = 0; y < scene.height(); ++y) {
    for (int k = 0; k < 3 * scene.width(); ++k) {
      const double truth = scene.row(y)[k];
      if (truth * s.exposures.front() > 1 || truth * s.exposures.back() < 6 * s.noise.stddev(0)) continue;
      const double error = merged.map.rgb.row(y)[k] - truth;
      ratio += error * error / cramer_rao_bound(s, truth);
      ++count;
    }
  }
  ASSERT_GT(count, 100000);
  EXPECT_LT(ratio / count, 1.15);
}

struct Normalised {
  double stddev = 0, p99 = 0;
};

/// (merged - truth) / standard deviation over the pixels that are no bounds.
Normalised normalised_errors(const Merged& merged, View<const float> scene) {
  std::vector<double> all;
  double squares = 0;
  for (int y = 0; y < scene.height(); ++y) {
    for (int x = 0; x < scene.width(); ++x) {
      if (merged.flags(x, y) != 0) continue;
      for (int c = 0; c < 3; ++c) {
        const double error = (merged.map.rgb(x, y, c) - scene(x, y, c)) / merged.map.stddev(x, y, c);
        all.push_back(std::abs(error));
        squares += error * error;
      }
    }
  }
  std::sort(all.begin(), all.end());
  return {std::sqrt(squares / static_cast<double>(all.size())), all[all.size() * 99 / 100]};
}

// Of lossless shots; the curve and the depth do not matter.
TEST_P(Likelihood, KnowsItsOwnError) {
  Camera camera = GetParam();
  camera.seed += 2000;
  const Image<float> scene = test::test_scene(300, 200, 8, camera.seed);
  for (const auto& [response, bits] : {std::pair{"linear", 16}, std::pair{"gamma:2.2", 8}, std::pair{"film", 8}}) {
    camera.response = response;
    camera.bits = bits;
    const Simulated s = photograph(camera, scene);
    for (const WeightKind weight : {WeightKind::kVariance, WeightKind::kHat}) {
      for (const bool told : {true, false}) {
        MergeOptions options = known_noise(s);
        options.weight = weight;
        if (!told) options.noise.reset();
        const Normalised error = normalised_errors(merge_in_scene_units(s, options), scene);
        const auto where = testing::Message() << response << (told ? ", noise known" : ", noise estimated")
                                              << (weight == WeightKind::kHat ? ", hat" : ", likelihood");
        EXPECT_GT(error.stddev, 0.8) << where;
        EXPECT_LT(error.stddev, 1.25) << where;
        EXPECT_LT(error.p99, 3.5) << where;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, Likelihood,
                         testing::Values(Camera{"linear", 16, 30000, 5, 1, 7, 1}, Camera{"linear", 16, 8000, 20, 2, 5, 2},
                                         Camera{"linear", 16, 90000, 2, 2, 6, 3}, Camera{"linear", 16, 12000, 12, 1, 9, 4},
                                         Camera{"linear", 16, 3000, 30, 1, 5, 5}));

}  // namespace
}  // namespace hdr
