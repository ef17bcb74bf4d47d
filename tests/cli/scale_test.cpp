// Absolute radiance and one scale across brackets, and the options of an honest merge, through the command.
#include "libhdr/core/color.h"
#include "libhdr/io/read.h"
#include "libhdr/light/horizontal_irradiance.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

class Scale : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }

  /// A bracket of a seeded scene by the command's own camera, f/8 and ISO 100 in EXIF; its bracket.json.
  Json shoot(const std::string& folder, const std::string& times, const std::string& level = ".18",
             Size size = {240, 160}) const {
    RadianceMap scene;
    scene.rgb = test_scene(size.width, size.height, 8, 5);
    write_map(scratch_ / "scene.exr", scene, {}, {SampleType::kFloat, "zip"});
    answer_of({"simulate", at("scene.exr"), "-o", at(folder), "--times", times, "--response", "srgb", "--format", "png",
               "--level", level});
    return Json::parse(bytes_of(scratch_ / folder / "bracket.json"));
  }
  /// Three photographs that know their times alone, sRGB, of a ramp.
  std::vector<std::string> shots_without_aperture() const {
    std::vector<std::string> files;
    for (int k = 0; k < 3; ++k) {
      Photo photo;
      photo.exposure.seconds = 0.01 * std::exp2(2 * k);
      Image<std::uint8_t> codes(64, 48, 3);
      for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64 * 3; ++x) {
          const double level = std::exp2(8.0 * (x / 3) / 64 - 9 + 2 * k);
          codes.row(y)[x] = static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(level)));
        }
      }
      photo.codes = std::move(codes);
      files.push_back(at("bare" + std::to_string(k) + ".png"));
      write_photo(files.back(), photo);
    }
    return files;
  }
  Json merge_of(const std::vector<std::string>& shots, const std::string& output,
                const std::vector<std::string>& more = {}) const {
    return answer_of(merge_line(shots, output, more));
  }
  std::vector<std::string> merge_line(const std::vector<std::string>& shots, const std::string& output,
                                      const std::vector<std::string>& more = {}) const {
    std::vector<std::string> line = {"merge"};
    line.insert(line.end(), shots.begin(), shots.end());
    line.insert(line.end(), {"-o", at(output), "--align", "none", "--response", "srgb", "--type", "float"});
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }
  Json white_of_file(const std::string& name) const {
    return answer_of({"info", at(name)})["files"][0]["white_luminance"];
  }
  static double mean_luminance(const RadianceMap& map, double cx, double cy, double r) {
    double sum = 0, count = 0;
    for (int y = 0; y < map.rgb.height(); ++y) {
      for (int x = 0; x < map.rgb.width(); ++x) {
        if (std::hypot(x + 0.5 - cx, y + 0.5 - cy) > r) continue;
        sum += luminance<double>(map.rgb(x, y, 0), map.rgb(x, y, 1), map.rgb(x, y, 2));
        ++count;
      }
    }
    return sum / count;
  }

  ScratchDir scratch_;
};

TEST_F(Scale, WhiteLuminanceFollowsTheExposureFormula) {
  const Json truth = shoot("shots", "1/1000,1/250,1/60,1/15,1/4");
  const Json merged = merge_of({at("shots")}, "map.exr");
  // The middle shot, 1/60 s at f/8 and ISO 100, gives the middle code to 12.5 * 64 / (1/60 * 100) = 480 cd/m^2.
  ASSERT_TRUE(merged.contains("white_luminance"));
  EXPECT_NEAR(merged["white_luminance"].get<double>(), 480, 480 * 1e-3);  // EXIF keeps times as fractions
  EXPECT_NEAR(merged["exposure_unit"].get<double>(), 1.0 / 60 / 64, 1e-3 / 60 / 64);
  EXPECT_NEAR(white_of_file("map.exr").get<double>(), merged["white_luminance"].get<double>(), 1e-2);
  EXPECT_NEAR(read_map(at("map.exr")).map.white_luminance.value(), 480, 0.5) << "and it comes back";
  // And radiance 1 is what gives the middle code there: level k L t of full well against that of code 128.
  const RadianceMap map = read_map(at("map.exr")).map;
  const Image<float> scene = test_scene(240, 160, 8, 5);
  const double unit_per_scene = truth["k"].get<double>() / 60 / linear_from_srgb(128.0 / 255);
  std::vector<double> ratios;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 240; ++x) ratios.push_back(map.rgb(x, y, 1) / (scene(x, y, 1) * unit_per_scene));
  }
  std::nth_element(ratios.begin(), ratios.begin() + 19200, ratios.end());
  EXPECT_NEAR(ratios[19200], 1, 0.01);
}

TEST_F(Scale, NothingIsSaidWhereApertureOrIsoAreUnknown) {
  const auto shots = shots_without_aperture();
  EXPECT_FALSE(merge_of(shots, "map.exr").contains("white_luminance"));
  EXPECT_TRUE(white_of_file("map.exr").is_null());
  // A list can say what EXIF does not.
  std::ofstream(scratch_ / "list.txt") << "bare0.png 0.01 16 100\nbare1.png 0.04 16 100\nbare2.png 0.16 16 100\n";
  const Json listed = merge_of(shots, "listed.exr", {"--exposures", at("list.txt")});
  EXPECT_NEAR(listed["white_luminance"].get<double>(), 12.5 * 256 / 4, 1e-6);
}

TEST_F(Scale, AKnownScaleIsWrittenAndThePixelsStay) {
  const auto shots = shots_without_aperture();
  merge_of(shots, "plain.exr");
  const Json merged = merge_of(shots, "known.exr", {"--cd-per-unit", "250"});
  EXPECT_EQ(merged["white_luminance"], 250.0);
  EXPECT_NEAR(white_of_file("known.exr").get<double>(), 250, 1e-3);
  EXPECT_EQ(answer_of({"diff", at("plain.exr"), at("known.exr")})["max_abs"], 0.0);
}

TEST_F(Scale, AKnownPatchHasItsLuminance) {
  const auto shots = shots_without_aperture();
  const Json merged = merge_of(shots, "patch.exr", {"--patch", "30.5,20,5=400"});
  const double white = merged["white_luminance"];
  EXPECT_NEAR(white * mean_luminance(read_map(at("patch.exr")).map, 30.5, 20, 5), 400, 0.01);
  // A grey card of 18 % under 1000 lux: 0.18 * 1000 / pi = 57.3 cd/m^2.
  const Json card = merge_of(shots, "card.exr", {"--patch", "30.5,20,5=18%", "--lux", "1000"});
  EXPECT_NEAR(card["white_luminance"].get<double>() / white, 57.2958 / 400, 1e-5);
  EXPECT_TRUE(merged.contains("warnings")) << "a ramp is no patch, and that is said";
  expect_refusal(merge_line(shots, "o.exr", {"--patch", "300,20,5=400"}), {"--patch", "64x48"});
  expect_refusal(merge_line(shots, "o.exr", {"--patch", "30,20,5"}), {"--patch", "CX,CY,R=CD"});
  expect_refusal(merge_line(shots, "o.exr", {"--patch", "30,20,-5=400"}), {"--patch", "radius"});
  expect_refusal(merge_line(shots, "o.exr", {"--patch", "30,20,5=nan"}), {"--patch"});
}

TEST_F(Scale, OptionsThatContradictEachOtherAreMisuse) {
  const auto shots = shots_without_aperture();
  const std::vector<std::vector<std::string>> misuses = {
      {"--lux", "100"},
      {"--patch", "30,20,5=18%"},
      {"--patch", "30,20,5=400", "--lux", "100"},
      {"--patch", "30,20,5=400", "--cd-per-unit", "2"},
      {"--cd-per-unit", "-2"},
      {"--cd-per-unit", "2", "--lux", "100"},
  };
  for (const auto& misuse : misuses) {
    const CommandResult result = run_hdr(merge_line(shots, "o.exr", misuse));
    EXPECT_EQ(result.exit_code, 2) << misuse[0] << " " << misuse[1] << "\n" << result.err;
    EXPECT_FALSE(std::filesystem::exists(scratch_ / "o.exr"));
  }
}

TEST_F(Scale, ProbeUnderAKnownIlluminance) {
  write_world(scratch_ / "world.exr");
  answer_of({"simulate", at("world.exr"), "-o", at("ball"), "--ball", "--size", "300x220", "--times",
             "1/1000,1/250,1/60,1/40,1/15,1/4"});
  for (const char* to : {"latlong", "angular"}) {
    const Json probe =
        answer_of({"probe", at("ball"), "-o", at("p.exr"), "--save-map", at("m.exr"), "--width", "256", "--ball",
                   "150,110,88", "--align", "none", "--type", "float", "--lux", "20000", "--to", to});
    const double white = probe["white_luminance"];
    answer_of({"unwrap", at("p.exr"), "-o", at("latlong.exr"), "--width", "256", "--type", "float"});
    const Rgb e = horizontal_irradiance(read_map(at("latlong.exr")).map.rgb);
    EXPECT_NEAR(white * luminance(e[0], e[1], e[2]) / 20000, 1, std::string(to) == "latlong" ? 1e-4 : 0.02) << to;
    EXPECT_NEAR(white_of_file("p.exr").get<double>() / white, 1, 1e-5);
    EXPECT_NEAR(white_of_file("m.exr").get<double>() / white, 1, 1e-5) << "the map beside it has the same unit";
  }
  expect_refusal({"probe", at("ball"), "-o", at("p.exr"), "--width", "64", "--ball", "150,110,88", "--align", "none",
                  "--lux", "20000", "--to", "rectilinear"},
                 {"--lux", "--to latlong"});
}

TEST_F(Scale, OneScaleAcrossBrackets) {
  shoot("short", "1/1000,1/250,1/60");  // of one scene: the middle shots are four stops apart
  Json truth = Json::parse(bytes_of(scratch_ / "short" / "bracket.json"));
  const double k_short = truth["k"];
  // The same camera and light: --level meters on the middle time, so it grows with it.
  truth = shoot("long", "1/60,1/15,1/4", "2.88");
  ASSERT_NEAR(truth["k"].get<double>() / k_short, 1, 0.1) << "one scene, one camera";
  const double same_light = k_short / truth["k"].get<double>();
  merge_of({at("short")}, "short.exr");
  const Json own = merge_of({at("long")}, "own.exr");
  const Json like = merge_of({at("long")}, "like.exr", {"--scale-like", at("short.exr")});
  EXPECT_NEAR(like["exposure_unit"].get<double>(), 1.0 / 250 / 64, 1e-3 / 250 / 64);
  EXPECT_NEAR(like["white_luminance"].get<double>(), 2000, 2) << "of short.exr";
  EXPECT_GT(own["exposure_unit"].get<double>() / like["exposure_unit"].get<double>(), 10);
  const RadianceMap a = read_map(at("short.exr")).map, b = read_map(at("like.exr")).map;
  std::vector<double> ratios;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 240; ++x) {
      // Seen well by both: not black in the short bracket nor clipped in the long one.
      if (a.rgb(x, y, 1) > 0.05 && a.rgb(x, y, 1) < 0.1) ratios.push_back(b.rgb(x, y, 1) / a.rgb(x, y, 1) * same_light);
    }
  }
  ASSERT_GT(ratios.size(), 300u);
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  EXPECT_NEAR(*middle, 1, 0.01);
}

TEST_F(Scale, AScaleFromAFileThatHasNoneOrAnotherKind) {
  const auto shots = shots_without_aperture();
  RadianceMap foreign;
  foreign.rgb = Image<float>(8, 8, 3);
  write_map(scratch_ / "foreign.exr", foreign);
  expect_refusal(merge_line(shots, "o.exr", {"--scale-like", at("foreign.exr")}), {"foreign.exr", "exposure_unit"});
  expect_refusal(merge_line(shots, "o.exr", {"--scale-like", at("absent.exr")}), {"absent.exr"});
  // Exposures with apertures and without count in different units.
  shoot("shots", "1/250,1/60,1/15");
  merge_of({at("shots")}, "full.exr");
  expect_refusal(merge_line(shots, "o.exr", {"--scale-like", at("full.exr")}), {"full.exr", "f_number", "--exposures"});
}

TEST_F(Scale, UncertaintyIsALayerAndHonest) {
  shoot("shots", "1/1000,1/250,1/60,1/15,1/4");
  merge_of({at("shots")}, "map.exr", {"--uncertainty"});
  const RadianceMap map = read_map(at("map.exr")).map;
  ASSERT_EQ(map.stddev.size(), map.rgb.size()) << "--uncertainty writes the layer stddev";
  const Image<float> scene = test_scene(240, 160, 8, 5);
  std::vector<double> ratios, errors;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 240; ++x) ratios.push_back(map.rgb(x, y, 1) / scene(x, y, 1));
  }
  std::nth_element(ratios.begin(), ratios.begin() + 19200, ratios.end());
  const double scale = ratios[19200];
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 240; ++x) {
      ASSERT_TRUE(map.stddev(x, y, 1) >= 0 && std::isfinite(map.stddev(x, y, 1)));
      const double level = scene(x, y, 1) / scene(120, 80, 1);
      if (level < 0.05 || level > 5) continue;  // well exposed in some shot
      errors.push_back(std::abs(map.rgb(x, y, 1) - scale * scene(x, y, 1)) / map.stddev(x, y, 1));
    }
  }
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  EXPECT_NEAR(*middle / 0.6745, 1, 0.3) << "half of the errors of a normal distribution are within .6745 deviations";
  merge_of({at("shots")}, "plain.exr");
  EXPECT_TRUE(read_map(at("plain.exr")).map.stddev.empty()) << "only when asked for";
}

TEST_F(Scale, AFlatFieldIsDividedOutAndHasTheMapsSize) {
  shoot("shots", "1/1000,1/250,1/60,1/15,1/4");
  const auto flat = [&](Size size, double fall) {
    RadianceMap map;
    map.rgb = Image<float>(size, 3);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        for (int c = 0; c < 3; ++c) map.rgb(x, y, c) = static_cast<float>(5 * (1 - fall * x / size.width));
      }
    }
    return map;
  };
  write_map(scratch_ / "flat.exr", flat({240, 160}, 0.5), {}, {SampleType::kFloat, "zip"});
  write_map(scratch_ / "small.exr", flat({24, 16}, 0.5));
  write_map(scratch_ / "black.exr", flat({240, 160}, 1.5), {}, {SampleType::kFloat, "zip"});
  merge_of({at("shots")}, "plain.exr");
  merge_of({at("shots")}, "mended.exr", {"--flat", at("flat.exr")});
  const RadianceMap plain = read_map(at("plain.exr")).map, mended = read_map(at("mended.exr")).map;
  const auto gain = [&](int x, int y) { return mended.rgb(x, y, 1) / plain.rgb(x, y, 1); };
  EXPECT_NEAR(gain(200, 70) / gain(40, 70), (1 - 0.5 * 40 / 240) / (1 - 0.5 * 200 / 240), 0.01)
      << "what the lens darkened is brightened as much";
  expect_refusal(merge_line({at("shots")}, "o.exr", {"--flat", at("small.exr")}), {"small.exr", "24x16", "240x160"});
  expect_refusal(merge_line({at("shots")}, "o.exr", {"--flat", at("black.exr")}), {"black.exr", "without light"});
}

TEST_F(Scale, ABlackLevelIsSubtracted) {
  // A camera that writes code 16 for no light: linear codes 16 + 239 level.
  std::vector<std::string> files;
  const auto level = [](int x, int shot) { return std::min(1.0, std::exp2(8.0 * x / 64 - 9 + 2 * shot)); };
  for (int k = 0; k < 3; ++k) {
    Photo photo;
    photo.exposure.seconds = 0.01 * std::exp2(2 * k);
    photo.bits = 16;
    Image<std::uint16_t> codes(64, 48, 3);
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64 * 3; ++x) {
        codes.row(y)[x] = static_cast<std::uint16_t>(std::lround(257 * (16 + 239 * level(x / 3, k))));
      }
    }
    photo.codes = std::move(codes);
    files.push_back(at("pedestal" + std::to_string(k) + ".png"));
    write_photo(files.back(), photo);
  }
  std::vector<std::string> line = merge_line(files, "map.exr", {"--black-level", std::to_string(16 * 257)});
  std::replace(line.begin(), line.end(), std::string("srgb"), std::string("linear"));
  answer_of(line);
  const RadianceMap map = read_map(at("map.exr")).map;
  for (const int x : {10, 20, 30, 40, 50}) {
    EXPECT_NEAR(std::log2(map.rgb(x, 20, 1) / map.rgb(32, 20, 1)), 8.0 * (x - 32) / 64, 0.02) << x;
  }
  const CommandResult negative = run_hdr(merge_line(files, "o.exr", {"--black-level", "-3"}));
  EXPECT_EQ(negative.exit_code, 2);
}

}  // namespace
}  // namespace hdr::test
