// Verbs about files and pictures: convert, filter, tonemap, fuse, and info on a bracket.
#include <cmath>

#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

class Files : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }
  RadianceMap map_of(const std::string& name, ReadMapOptions options = {}) const {
    return read_map(at(name), options).map;
  }

  /// A photograph of a ramp of 9 stops, `stops` brighter.
  void photo(const std::string& name, double stops, Exposure exposure) const {
    Photo photo;
    photo.exposure = exposure;
    Image<std::uint8_t> codes(120, 80, 3);
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 360; ++x) {
        const double level = std::exp2(9.0 * (x / 3) / 120 - 8 + stops + 0.2 * std::sin(y));
        codes.row(y)[x] = static_cast<std::uint8_t>(std::lround(255 * std::pow(std::min(1.0, level), 1 / 2.2)));
      }
    }
    photo.codes = std::move(codes);
    write_photo(scratch_ / name, photo);
  }

  ScratchDir scratch_;
};

TEST_F(Files, ConvertKeepsTheLightThroughEveryFormat) {
  write_world(scratch_ / "world.exr", 64);
  const Image<float> truth = map_of("world.exr").rgb.clone();
  const std::pair<const char*, double> formats[] = {{"a.pfm", 0}, {"a.tif", 0}, {"b.exr", 0}, {"a.hdr", 1 / 256.0}};
  std::string from = "world.exr";
  for (const auto& [name, tolerance] : formats) {
    answer_of({"convert", at(from), at(name), "--type", "float"});
    const RadianceMap map = map_of(name);
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 64; ++x) {
        const double largest = std::max({truth(x, y, 0), truth(x, y, 1), truth(x, y, 2)});
        for (int c = 0; c < 3; ++c) ASSERT_LE(std::abs(map.rgb(x, y, c) - truth(x, y, c)), tolerance * largest) << name;
      }
    }
    from = name;
  }
  EXPECT_EQ(map_of("a.hdr").projection, "") << "a PFM in between cannot say it";
  answer_of({"convert", at("world.exr"), at("direct.hdr")});
  EXPECT_EQ(map_of("direct.hdr").projection, "latlong");
  answer_of({"convert", at("direct.hdr"), at("middle.exr"), "--mantissa", "middle", "--type", "float"});
  EXPECT_GT(map_of("middle.exr").rgb(5, 5, 1), map_of("direct.hdr").rgb(5, 5, 1));
  EXPECT_EQ(run_hdr({"convert", at("world.exr"), at("x.pfm"), "--mantissa", "none"}).exit_code, 2);
}

TEST_F(Files, ConvertToAPictureSaysWhatItClips) {
  write_world(scratch_ / "world.exr", 64);
  const Json answer = answer_of({"convert", at("world.exr"), at("a.png")});
  ASSERT_TRUE(answer.contains("warnings"));
  EXPECT_NE(answer["warnings"].back().get<std::string>().find("samples above 1 were clipped"), std::string::npos);
  // A picture through linear light and back is itself.
  answer_of({"convert", at("a.png"), at("b.exr"), "--type", "float"});
  answer_of({"convert", at("b.exr"), at("c.png")});
  EXPECT_EQ(bytes_of(scratch_ / "a.png"), bytes_of(scratch_ / "c.png"));
}

TEST_F(Files, FilterKnowsTheSphereWhereTheFileSaysSo) {
  RadianceMap map;
  map.rgb = Image<float>(64, 32, 3);
  for (int c = 0; c < 3; ++c) map.rgb(63, 16, c) = 1e4f;
  write_map(scratch_ / "plain.exr", map, {}, {SampleType::kFloat, "zip"});
  map.projection = "latlong";
  map.white_luminance = 100;
  write_map(scratch_ / "sphere.exr", map, {}, {SampleType::kFloat, "zip"});
  EXPECT_EQ(answer_of({"filter", at("sphere.exr"), "-o", at("s.exr"), "--gaussian", "2", "--type", "float"})["surface"],
            "latlong");
  EXPECT_GT(map_of("s.exr").rgb(0, 16, 1), 100) << "the seam is no border";
  EXPECT_EQ(map_of("s.exr").projection, "latlong");
  const Json plane = answer_of({"filter", at("plain.exr"), "-o", at("p.exr"), "--gaussian", "2", "--type", "float"});
  EXPECT_EQ(plane["surface"], "plane");
  EXPECT_NE(plane["warnings"][0].get<std::string>().find("--from latlong"), std::string::npos);
  EXPECT_NEAR(map_of("p.exr").rgb(0, 16, 1), 0, 1e-3);
  answer_of({"filter", at("plain.exr"), "-o", at("m.exr"), "--from", "latlong", "--motion", "4@0", "--type", "float"});
  EXPECT_NEAR(map_of("m.exr").rgb(0, 16, 1), 2500, 0.1);
  answer_of({"filter", at("sphere.exr"), "-o", at("d.exr"), "--stops", "-2", "--type", "float"});
  EXPECT_EQ(map_of("d.exr").rgb(63, 16, 0), 2500);
  EXPECT_EQ(map_of("d.exr").white_luminance, 400) << "the numbers are a quarter, the light is not";
}

TEST_F(Files, FilterMisuseIsMisuse) {
  write_world(scratch_ / "world.exr", 16);
  const std::vector<std::string> base = {"filter", at("world.exr"), "-o", at("o.exr")};
  const auto code = [&](std::vector<std::string> more) {
    more.insert(more.begin(), base.begin(), base.end());
    return run_hdr(more).exit_code;
  };
  EXPECT_EQ(code({}), 2);
  EXPECT_EQ(code({"--gaussian", "-1"}), 2);
  EXPECT_EQ(code({"--gaussian", "nan"}), 2);
  EXPECT_EQ(code({"--motion", "five"}), 2);
  EXPECT_EQ(code({"--motion", "5@"}), 2);
  EXPECT_EQ(code({"--motion", "5@30x"}), 2);
  EXPECT_EQ(code({"--motion", "5@30"}), 0);
  EXPECT_EQ(code({"--motion", "5"}), 0);
  EXPECT_EQ(code({"--motion", "1e9@0"}), 1);
}

TEST_F(Files, EveryOperatorMakesAPicture) {
  write_world(scratch_ / "world.exr", 96);
  for (const char* tone : {"reinhard", "filmic", "local", "clip"}) {
    answer_of({"tonemap", at("world.exr"), "-o", at("a.png"), "--operator", tone});
    EXPECT_EQ(read_photo(scratch_ / "a.png").size(), (Size{96, 48})) << tone;
  }
  const Json answer = answer_of({"tonemap", at("world.exr"), "-o", at("f.png"), "--operator", "false-colour"});
  EXPECT_LT(answer["legend"]["lowest"].get<int>(), answer["legend"]["highest"].get<int>());
  EXPECT_GT(read_photo(scratch_ / "f.png").height(), 48) << "with a legend";
}

TEST_F(Files, InfoJudgesABracket) {
  photo("a.png", -2, {1 / 250.0, 8.0, 100.0, 0});
  photo("b.png", 0, {1 / 60.0, 8.0, 100.0, 0});
  photo("c.png", 2, {1 / 60.0, 8.0, 400.0, 0});  // by ISO
  const Json bracket = answer_of({"info", scratch_.path().string()})["bracket"];
  ASSERT_EQ(bracket["shots"].size(), 3u);
  EXPECT_NEAR(bracket["shots"][2]["step"].get<double>(), 2, 1e-9) << "the ISO speed counts";
  EXPECT_NEAR(bracket["span_ev"].get<double>(), 2 + std::log2(250 / 60.0), 1e-9);
  EXPECT_TRUE(bracket["missing"].is_array());
  photo("d.png", 1, {1 / 250.0, 8.0, 100.0, 0});
  photo("e.png", 3, {1 / 250.0, 8.0, 100.0, 0});
  const Json refused = answer_of({"info", at("d.png"), at("e.png")})["bracket"];
  EXPECT_NE(refused["refused"].get<std::string>().find("same exposure"), std::string::npos);
  EXPECT_FALSE(answer_of({"info", at("a.png")}).contains("bracket")) << "one photograph is none";
  const CommandResult text = run_hdr({"info", at("a.png"), at("b.png")});
  EXPECT_NE(text.out.find("As a bracket: 2 shots"), std::string::npos) << text.out;
}

TEST_F(Files, FuseNeedsNoTimes) {
  photo("a.png", -2, {});
  photo("b.png", 2, {});
  const Json answer = answer_of({"fuse", at("a.png"), at("b.png"), "-o", at("f.png")});
  EXPECT_EQ(answer["width"], 120);
  EXPECT_NE(answer["warnings"][0].get<std::string>().find("not registered"), std::string::npos);
  photo("c.png", -2, {1 / 250.0, {}, {}, 0});
  photo("d.png", 2, {1 / 15.0, {}, {}, 0});
  EXPECT_TRUE(answer_of({"fuse", at("c.png"), at("d.png"), "-o", at("g.png")}).contains("frames")) << "registered";
  EXPECT_EQ(read_photo(scratch_ / "g.png").size(), (Size{120, 80}));
}

}  // namespace
}  // namespace hdr::test
