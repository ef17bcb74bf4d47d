// Brackets at the edge of what can be merged: a clear line of error, or a result that is right against the truth; and
// never NaN, infinite or negative radiance.
#include <limits>
#include <numeric>

#include "libhdr/io/read.h"
#include "libhdr/response/expose.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

/// Photographs of `scene`, and the camera that took them: level = scene * kSensitivity * seconds of full well.
struct Shots {
  std::vector<std::string> files;
  std::vector<double> times;
  Image<float> scene;
};
constexpr double kSensitivity = 0.18;

struct Plan {
  std::vector<double> evs = {-6, -4, -2, 0, 0.67, 2, 4};
  Response response = srgb_response(8);
  double stops = 9;
  Size size{160, 120};
  std::uint64_t seed = 3;
  std::string format = "png";
};

class Stability : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }

  Shots shoot(const Plan& plan, const std::string& name = "shot") const {
    Shots shots;
    shots.scene = test_scene(plan.size.width, plan.size.height, plan.stops, plan.seed);
    for (const double ev : plan.evs) {
      shots.times.push_back(std::exp2(ev));
      const Photo photo = photograph(shots.scene, shots.times.back(), plan, shots.files.size());
      shots.files.push_back(
          at(name + (shots.files.size() < 10 ? "0" : "") + std::to_string(shots.files.size()) + "." + plan.format));
      write_photo(shots.files.back(), photo);
    }
    return shots;
  }
  static Photo photograph(View<const float> scene, double seconds, const Plan& plan, std::uint64_t noise_seed) {
    Exposure exposure;
    exposure.seconds = seconds;
    return expose(scene, exposure, {plan.response, {}, kSensitivity}, 100 * plan.seed + noise_seed);
  }

  static std::string text_of(const std::vector<double>& times) {
    std::ostringstream text;
    text.precision(17);
    for (std::size_t k = 0; k < times.size(); ++k) text << (k ? "," : "") << times[k];
    return text.str();
  }
  std::vector<std::string> merge_line(const std::vector<std::string>& files, std::vector<std::string> more = {}) const {
    std::vector<std::string> line = {"merge"};
    line.insert(line.end(), files.begin(), files.end());
    line.insert(line.end(), {"-o", at("map.exr")});
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }
  /// Merges in float on the shots' own grid; the map as written, each sample finite and not negative.
  RadianceMap merged(const std::vector<std::string>& files, std::vector<std::string> more = {},
                     Json* answer = nullptr) const {
    more.insert(more.end(), {"--type", "float", "--align", "none"});
    const Json answered = answer_of(merge_line(files, std::move(more)));
    if (answer) *answer = answered;
    if (answered.empty()) return {};
    RadianceMap map = read_map(at("map.exr"), {NonFinite::kKeep}).map;
    int bad = 0;
    for (int y = 0; y < map.rgb.height(); ++y) {
      for (const float* v = map.rgb.row(y); v != map.rgb.row(y) + map.rgb.row_samples(); ++v) {
        bad += !(std::isfinite(*v) && *v >= 0);
      }
    }
    EXPECT_EQ(bad, 0) << "samples that are NaN, infinite or negative";
    return map;
  }

  struct Errors {
    double median = 0, p99 = 0;  ///< |log2| of the map over the truth, a scale a channel taken out
    std::size_t samples = 0;
  };
  /// Over samples that some shot exposes well: its level lies in [.02, .9] of full well.
  static Errors errors_of(const RadianceMap& map, const Shots& shots, const std::vector<int>& channels = {0, 1, 2}) {
    std::vector<double> errors;
    for (const int c : channels) {
      std::vector<double> logs;
      for (int y = 0; y < map.rgb.height(); ++y) {
        for (int x = 0; x < map.rgb.width(); ++x) {
          const double light = kSensitivity * shots.scene(x, y, c);
          const bool well = std::any_of(shots.times.begin(), shots.times.end(),
                                        [&](double t) { return light * t >= 0.02 && light * t <= 0.9; });
          if (well) logs.push_back(std::log2(map.rgb(x, y, c) / shots.scene(x, y, c)));
        }
      }
      if (logs.empty()) continue;
      const double scale = quantile(logs, 0.5);
      for (const double l : logs) errors.push_back(std::abs(l - scale));
    }
    if (errors.empty()) return {};
    return {quantile(errors, 0.5), quantile(errors, 0.99), errors.size()};
  }
  static double quantile(std::vector<double>& values, double q) {
    const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<std::size_t>(k)];
  }
  static void expect_right(const Errors& errors, double median, double p99) {
    EXPECT_GT(errors.samples, 100u);
    EXPECT_LE(errors.median, median);
    EXPECT_LE(errors.p99, p99);
  }

  ScratchDir scratch_;
};

TEST_F(Stability, AGoodBracketIsRight) {
  const Shots shots = shoot({});
  expect_right(errors_of(merged(shots.files), shots), 0.02, 0.15);
}

TEST_F(Stability, OneShot) {
  const Shots shots = shoot({.evs = {0}, .stops = 16});
  Json answer;
  const RadianceMap map = merged(shots.files, {"--response", "srgb"}, &answer);
  expect_right(errors_of(map, shots), 0.03, 0.15);
  EXPECT_GT(answer["clipped"].get<int>(), 0) << "sixteen stops do not fit in one shot";
  EXPECT_GT(answer["dark"].get<int>(), 0);
  // What clips keeps its order: never below what is measured at the end of the scale.
  float brightest_measured = 0, darkest_clipped = std::numeric_limits<float>::infinity();
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const double level = kSensitivity * shots.scene(x, y, 1);
      if (level < 0.95) brightest_measured = std::max(brightest_measured, map.rgb(x, y, 1));
      if (level > 1.1) darkest_clipped = std::min(darkest_clipped, map.rgb(x, y, 1));
    }
  }
  EXPECT_GE(darkest_clipped, 0.99f * brightest_measured);
  expect_refusal(merge_line(shots.files), {"shot00.png", "--response"});
}

TEST_F(Stability, EqualTimes) {
  const Shots equal = shoot({.evs = {0, 0, 0}});
  expect_refusal(merge_line(equal.files), {"shot00.png", "same exposure", "--times"});
  // Repeats within a bracket are welcome.
  const Shots repeats = shoot({.evs = {-5, -5, -2.33, -2.33, 0, 0, 2, 4, 4}}, "repeat");
  expect_right(errors_of(merged(repeats.files), repeats), 0.02, 0.15);
}

TEST_F(Stability, ShuffledPairsGiveTheSameBytes) {
  const Shots shots = shoot({});
  std::vector<std::string> shuffled;
  std::vector<double> times;
  for (const std::size_t k : {3u, 0u, 6u, 1u, 5u, 2u, 4u}) {
    shuffled.push_back(shots.files[k]);
    times.push_back(shots.times[k]);
  }
  // EXIF holds times as fractions: both runs take the list's.
  merged(shots.files, {"--times", text_of(shots.times), "--threads", "1"});
  const std::string straight = bytes_of(scratch_ / "map.exr");
  merged(shuffled, {"--times", text_of(times), "--threads", "2"});
  std::string other = bytes_of(scratch_ / "map.exr");
  // Provenance repeats the command's own --times, which were given in another order; all else is the same.
  const std::size_t a = straight.find(text_of(shots.times)), b = other.find(text_of(times));
  ASSERT_TRUE(a != std::string::npos && a == b);
  other.replace(b, text_of(times).size(), text_of(shots.times));
  EXPECT_TRUE(straight == other) << "the map depends on the order in which the shots were named";
  // From EXIF there is no list to repeat.
  merged(shots.files);
  const std::string named = bytes_of(scratch_ / "map.exr");
  merged(shuffled);
  EXPECT_TRUE(named == bytes_of(scratch_ / "map.exr"));
}

TEST_F(Stability, TimesReversedAgainstTheFilesNameTwoShots) {
  const Shots shots = shoot({});
  std::vector<double> reversed(shots.times.rbegin(), shots.times.rend());
  for (const char* response : {"fit", "srgb"}) {
    const auto line = merge_line(shots.files, {"--times", text_of(reversed), "--response", response});
    const CommandResult result = run_hdr(line);
    EXPECT_EQ(result.exit_code, 1);
    std::size_t named = 0;
    for (const std::string& file : shots.files) named += result.err.find(file) != std::string::npos;
    EXPECT_EQ(named, 2u) << result.err;
    expect_refusal(line, {"--times"});
  }
}

TEST_F(Stability, AllBlack) {
  Plan plan{.evs = {-2, 0, 2}, .size = {48, 32}};
  Shots shots = shoot(plan);
  const Image<float> nothing(48, 32, 3);
  for (std::size_t k = 0; k < 3; ++k) {
    plan.response = srgb_response(8);
    Photo photo = photograph(nothing, shots.times[k], plan, k);
    std::get<Image<std::uint8_t>>(photo.codes) = Image<std::uint8_t>(48, 32, 3);
    write_photo(shots.files[k], photo);
  }
  expect_refusal(merge_line(shots.files), {"shot00.png", "response"});
  Json answer;
  const RadianceMap map = merged(shots.files, {"--response", "srgb"}, &answer);
  EXPECT_EQ(answer["dark"], 48 * 32);
  EXPECT_EQ(answer["clipped"], 0);
  // An upper bound: below what would have given code 1 in the longest shot (code 1 / 255 is 1/12.92/255 in sRGB).
  const double code_one = 1 / 12.92 / 255 / (0.2158605 * 4);
  for (int x = 0; x < 48; ++x) EXPECT_LE(map.rgb(x, 7, 1), code_one);
}

TEST_F(Stability, AllWhite) {
  const Plan plan{.evs = {-2, 0, 2}, .size = {48, 32}};
  Shots shots = shoot(plan);
  Image<float> glare(48, 32, 3);
  for (int y = 0; y < 32; ++y) std::fill(glare.row(y), glare.row(y) + 48 * 3, 1e5f);
  for (std::size_t k = 0; k < 3; ++k) write_photo(shots.files[k], photograph(glare, shots.times[k], plan, k));
  expect_refusal(merge_line(shots.files), {"shot00.png", "response"});
  Json answer;
  const RadianceMap map = merged(shots.files, {"--response", "srgb"}, &answer);
  EXPECT_EQ(answer["clipped"], 48 * 32);
  EXPECT_EQ(answer["dark"], 0);
  // A lower bound, and no more than is known: full well in the shortest shot, two stops under the middle one.
  const double saturation = 4 / 0.2158605;
  for (int x = 0; x < 48; ++x) {
    EXPECT_NEAR(map.rgb(x, 7, 1) / saturation, 1, 0.02);
    EXPECT_FLOAT_EQ(map.rgb(x, 7, 0), map.rgb(x, 7, 1)) << "white, not magenta";
    EXPECT_FLOAT_EQ(map.rgb(x, 7, 2), map.rgb(x, 7, 1));
  }
}

TEST_F(Stability, SixteenBits) {
  for (const char* format : {"png", "tif"}) {
    const Shots shots = shoot({.response = gamma_response(16, 2.2), .format = format}, format);
    expect_right(errors_of(merged(shots.files), shots), 0.01, 0.08);
  }
}

TEST_F(Stability, OneChannelClipped) {
  const Shots shots = shoot({});
  for (std::size_t k = 0; k < shots.files.size(); ++k) {
    Photo photo = read_photo(shots.files[k]);
    auto& codes = std::get<Image<std::uint8_t>>(photo.codes);
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) codes(x, y, 0) = 255;
    }
    write_photo(shots.files[k], photo);
  }
  Json answer;
  const RadianceMap map = merged(shots.files, {}, &answer);
  expect_right(errors_of(map, shots, {1, 2}), 0.02, 0.15);
  EXPECT_EQ(answer["clipped"], 160 * 120);
  EXPECT_TRUE(answer.contains("warnings")) << "that red has no curve of its own is said";
  for (int x = 0; x < 160; x += 7) EXPECT_GT(map.rgb(x, 60, 0), 20) << "what clips at 2^-6 s is bright";
}

TEST_F(Stability, TwoByTwoPixels) {
  const Shots shots = shoot({.stops = 4, .size = {2, 2}});
  const RadianceMap map = merged(shots.files, {"--response", "srgb"});
  for (int c = 0; c < 3; ++c) {
    const double scale = map.rgb(0, 0, c) / shots.scene(0, 0, c);
    for (int k = 1; k < 4; ++k) {
      EXPECT_NEAR(std::log2(map.rgb(k % 2, k / 2, c) / shots.scene(k % 2, k / 2, c) / scale), 0, 0.1) << k << " " << c;
    }
  }
  // Four pixels do not determine a curve, unless they are seen often: an error, or a map that is right.
  const CommandResult fitted = run_hdr(merge_line(shots.files, {"--type", "float"}));
  if (fitted.exit_code == 0) {
    const RadianceMap own = merged(shots.files);
    EXPECT_NEAR(std::log2(own.rgb(1, 0, 1) / own.rgb(0, 0, 1) * shots.scene(0, 0, 1) / shots.scene(1, 0, 1)), 0, 0.3);
  } else {
    expect_refusal(merge_line(shots.files), {"shot00.png", "response"});
  }
  answer_of(merge_line(shots.files, {"--response", "srgb"}));  // with alignment: nothing to align, and no crash
}

TEST_F(Stability, MixedSizes) {
  const Shots shots = shoot({});
  Plan small{.evs = {2}, .size = {80, 60}};
  write_photo(shots.files[3], photograph(test_scene(80, 60, 9, 3), shots.times[3], small, 1));
  expect_refusal(merge_line(shots.files), {"shot03.png", "80x60", "160x120"});
  // Trimmed by hand, by a few pixels: what they share is merged, and that is said.
  Photo trimmed = photograph(shots.scene, shots.times[3], {}, 3);
  Image<std::uint8_t> cut(157, 118, 3);
  for (int y = 0; y < 118; ++y) std::copy_n(std::get<0>(trimmed.codes).row(y), 157 * 3, cut.row(y));
  trimmed.codes = std::move(cut);
  write_photo(shots.files[3], trimmed);
  Json answer;
  const RadianceMap map = merged(shots.files, {}, &answer);
  EXPECT_EQ(map.size(), (Size{157, 118}));
  EXPECT_TRUE(answer.contains("warnings"));
  expect_right(errors_of(map, shots), 0.02, 0.15);
}

TEST_F(Stability, EighteenStopsOfTimes) {
  Plan plan{.evs = {-13, -10, -7, -4, -1, 2, 5}, .stops = 16};
  Shots shots = shoot(plan);
  expect_right(errors_of(merged(shots.files, {"--times", text_of(shots.times), "--response", "srgb"}), shots), 0.03,
               0.2);
  expect_right(errors_of(merged(shots.files, {"--times", text_of(shots.times)}), shots), 0.05, 0.35);
}

TEST_F(Stability, TimesThatAreNoTimes) {
  const Shots shots = shoot({.evs = {-4, 0, 4}});
  for (const char* times : {"nan,1,16", "0,1,16", "-.25,1,16", "inf,1,16", "1/0,1,16"}) {
    expect_refusal(merge_line(shots.files, {"--times", times}), {"--times", "shot00.png"});
    expect_refusal(merge_line(shots.files, {"--times", times, "--response", "srgb"}), {"--times", "shot00.png"});
  }
  for (const char* time : {"nan", "0", "-0.25", "inf", "1/0"}) {
    std::ofstream(scratch_ / "list.txt") << "shot00.png 1\nshot01.png " << time << "\nshot02.png 16\n";
    expect_refusal(merge_line(shots.files, {"--exposures", at("list.txt")}), {"list.txt:2"});
  }
  // Apertures and ISO speeds that are none; a list that leaves a shot without a time.
  std::ofstream(scratch_ / "list.txt") << "shot00.png .0625 0\nshot01.png 1 8\nshot02.png 16 8\n";
  expect_refusal(merge_line(shots.files, {"--exposures", at("list.txt")}), {"list.txt:1"});
  std::ofstream(scratch_ / "list.txt") << "shot00.png .0625 8 -100\nshot01.png 1 8 100\nshot02.png 16 8 100\n";
  expect_refusal(merge_line(shots.files, {"--exposures", at("list.txt")}), {"list.txt:1"});
}

TEST_F(Stability, GreyPhotographs) {
  const Shots shots = shoot({});
  std::vector<std::string> files;
  for (std::size_t k = 0; k < shots.files.size(); ++k) {
    const Photo photo = read_photo(shots.files[k]);
    files.push_back(at("grey" + std::to_string(k) + ".pgm"));
    std::ofstream file(files.back(), std::ios::binary);
    file << "P5\n160 120\n255\n";
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) file.put(static_cast<char>(std::get<0>(photo.codes)(x, y, 1)));
    }
  }
  const RadianceMap map = merged(files, {"--times", text_of(shots.times)});
  expect_right(errors_of(map, shots, {1}), 0.02, 0.15);
  for (int x = 0; x < 160; ++x) {
    EXPECT_EQ(map.rgb(x, 60, 0), map.rgb(x, 60, 1)) << "grey stays grey";
    EXPECT_EQ(map.rgb(x, 60, 2), map.rgb(x, 60, 1));
  }
}

TEST_F(Stability, AShotOfAnotherScene) {
  const Shots shots = shoot({.size = {240, 180}});
  for (const std::size_t intruder : {0u, 3u, 6u}) {
    const Photo own = read_photo(shots.files[intruder]);
    // As bright and as rich, but its range runs from top to bottom.
    const Image<float> tall = test_scene(180, 240, 9, 77);
    Image<float> elsewhere(240, 180, 3);
    for (int y = 0; y < 180; ++y) {
      for (int x = 0; x < 240; ++x) std::copy_n(tall.pixel(y, x), 3, elsewhere.pixel(x, y));
    }
    write_photo(shots.files[intruder], photograph(elsewhere, shots.times[intruder], {}, 9));
    const std::string name = std::filesystem::path(shots.files[intruder]).filename().string();
    for (const char* align : {"auto", "none"}) {
      expect_refusal(merge_line(shots.files, {"--align", align}), {name, "another scene"});
    }
    expect_refusal(merge_line(shots.files, {"--response", "srgb"}), {name, "another scene"});
    write_photo(shots.files[intruder], own);
  }
  // A thing that crosses one shot is no other scene.
  Photo crossed = read_photo(shots.files[3]);
  for (int y = 40; y < 160; ++y) {
    for (int x = 30; x < 90; ++x) {
      for (int c = 0; c < 3; ++c) std::get<0>(crossed.codes)(x, y, c) = static_cast<std::uint8_t>(90 + 20 * c);
    }
  }
  write_photo(shots.files[3], crossed);
  const RadianceMap map = merged(shots.files);
  EXPECT_LE(errors_of(map, shots).median, 0.03) << "the curve must not suffer from it";
}

TEST_F(Stability, FortyShots) {
  Plan plan;
  plan.evs.clear();
  for (int k = 0; k < 40; ++k) plan.evs.push_back(-7 + 12.0 * k / 39);
  const Shots shots = shoot(plan);
  Json answer;
  expect_right(errors_of(merged(shots.files, {}, &answer), shots), 0.01, 0.08);
  EXPECT_EQ(answer["frames"].size(), 40u);
}

TEST_F(Stability, RadianceOverTwelveOrdersOfMagnitude) {
  Plan plan{.stops = 40, .size = {320, 90}, .seed = 8};
  plan.evs.clear();
  for (int k = 0; k <= 17; ++k) plan.evs.push_back(-22 + 2.5 * k);
  const Shots shots = shoot(plan);
  const std::vector<std::string> known = {"--times", text_of(shots.times), "--response", "srgb"};
  const RadianceMap map = merged(shots.files, known);
  expect_right(errors_of(map, shots), 0.03, 0.3);
  const auto [low, high] = std::minmax_element(shots.scene.row(45), shots.scene.row(45) + 320 * 3);
  ASSERT_GT(*high / *low, 1e12) << "the scene has the range that the test speaks of";
  std::vector<std::string> half = known;
  half.insert(half.end(), {"--type", "half", "--align", "none"});
  expect_refusal(merge_line(shots.files, half), {"map.exr", "half", "--type float"});
  EXPECT_TRUE(std::filesystem::exists(scratch_ / "map.exr")) << "the earlier map is not lost";
  expect_right(errors_of(merged(shots.files, {"--times", text_of(shots.times)}), shots), 0.05, 0.4);
}

}  // namespace
}  // namespace hdr::test
