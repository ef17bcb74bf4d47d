// Light that changes from shot to shot, through the command.
#include "libhdr/io/read.h"
#include "libhdr/response/expose.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

class DriftCommand : public ::testing::Test {
 protected:
  /// ln; mean zero and no slope against ln exposure, so that they can be measured.
  const std::vector<double> ln_gain_{0.06, -0.12, 0, 0.12, -0.06};
  const Image<float> scene_ = test_scene(240, 160, 7, 4);
  ScratchDir scratch_;

  std::string at(const std::string& name) const { return (scratch_ / name).string(); }

  /// Five shots two stops apart; EXIF says nothing of the light.
  void SetUp() override {
    std::filesystem::create_directories(at("shots"));
    for (std::size_t k = 0; k < ln_gain_.size(); ++k) {
      Exposure exposure;
      exposure.seconds = std::exp2(2 * static_cast<double>(k) - 8);
      const double level = 0.18 * std::exp2(4) * std::exp(ln_gain_[k]);
      const Photo shot = expose(scene_, exposure, Sensor{srgb_response(8), NoiseModel{}, level}, 40 + k);
      write_photo(at("shots/") + std::to_string(k) + ".png", shot);
    }
  }

  Json merged(const std::string& map, const std::vector<std::string>& more) const {
    std::vector<std::string> line = {"merge",      at("shots"), "-o",      at(map),
                                     "--response", "srgb",      "--times", "1/256,1/64,1/16,1/4,1",
                                     "--align",    "none",      "--type",  "float"};
    line.insert(line.end(), more.begin(), more.end());
    return answer_of(line);
  }

  /// Standard deviation of ln(map / scene).
  double spread(const std::string& name) const {
    const Image<float> map = read_map(at(name)).map.rgb;
    double sum = 0, squares = 0, count = 0;
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) {
        const double ln = std::log(map(x, y, 1) / scene_(x, y, 1));
        sum += ln;
        squares += ln * ln;
        ++count;
      }
    }
    return std::sqrt(squares / count - sum * sum / (count * count));
  }
};

TEST_F(DriftCommand, GainsAreReportedAndUsed) {
  const Json plain = merged("plain.exr", {});
  for (const Json& frame : plain["frames"]) {
    EXPECT_FALSE(frame.contains("gain") || frame.contains("gain_deviation") || frame.contains("gain_unknown"))
        << "nobody asked: " << frame;
  }
  const Json drift = merged("drift.exr", {"--drift"});
  ASSERT_EQ(drift["frames"].size(), ln_gain_.size());
  for (std::size_t k = 0; k < ln_gain_.size(); ++k) {
    const Json& frame = drift["frames"][k];
    EXPECT_NEAR(std::log(frame["gain"].get<double>()), ln_gain_[k], 0.01) << frame;
    EXPECT_LT(frame["gain_deviation"], 0.01) << frame;
    EXPECT_FALSE(frame.contains("gain_unknown")) << frame;
  }
  EXPECT_LT(spread("drift.exr"), 0.7 * spread("plain.exr")) << "the map is not closer to the scene";
}

TEST_F(DriftCommand, ThreadsChangeNothing) {
  merged("one.exr", {"--drift", "--threads", "1"});
  merged("three.exr", {"--drift", "--threads", "3"});
  EXPECT_TRUE(bytes_of(at("one.exr")) == bytes_of(at("three.exr")));
}

TEST_F(DriftCommand, TwoShotsSayWhyTheyHaveNoGain) {
  const Json answer = answer_of({"merge", at("shots/1.png"), at("shots/2.png"), "-o", at("two.exr"), "--response",
                                 "srgb", "--times", "1/64,1/16", "--align", "none", "--drift"});
  for (const Json& frame : answer["frames"]) {
    EXPECT_EQ(frame["gain"], 1);
    EXPECT_TRUE(frame["gain_deviation"].is_null());
    EXPECT_NE(frame["gain_unknown"].get<std::string>().find("only two shots"), std::string::npos) << frame;
  }
}

}  // namespace
}  // namespace hdr::test
