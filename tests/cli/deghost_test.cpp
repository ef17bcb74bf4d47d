// Removing ghosts through the command.
#include "libhdr/io/read.h"
#include "tests/cli/fixture.h"
#include "tests/support/movers.h"

namespace hdr::test {
namespace {

class DeghostCommand : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return (scratch_ / name).string(); }
  void write_shots(const Bracket& bracket, const std::string& folder) const {
    std::filesystem::create_directories(at(folder));
    for (std::size_t k = 0; k < bracket.shots.size(); ++k) {
      write_photo(at(folder) + "/shot" + std::to_string(k) + ".png", bracket.shots[k]);
    }
  }
  ScratchDir scratch_;
};

TEST_F(DeghostCommand, SaysWhereAndWritesTheMask) {
  const MovingScene scene = moving_scene(MoverPlan{});
  write_shots(scene.moving, "moving");
  const Json answer = answer_of(
      {"merge", at("moving"), "-o", at("map.exr"), "--response", "srgb", "--deghost", "--ghost-mask", at("mask.png")});
  const Json& ghosts = answer["deghost"];
  ASSERT_FALSE(ghosts["regions"].empty());
  const Json& region = ghosts["regions"][0];
  EXPECT_EQ(region["box"].size(), 4u);
  EXPECT_GT(region["pixels"], 0);
  EXPECT_NE(region["reference"].get<std::string>().find("moving/shot"), std::string::npos);
  EXPECT_FALSE(region["left_out"].empty());
  const Photo mask = read_photo(at("mask.png"));
  const auto& codes = std::get<Image<std::uint8_t>>(mask.codes);
  double touched = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) touched += codes(x, y, 1) > 0;
  }
  EXPECT_NEAR(touched / (mask.width() * mask.height()), ghosts["share"].get<double>(), 1e-6);
  answer_of(
      {"merge", at("moving"), "-o", at("map.exr"), "--response", "srgb", "--deghost", "--ghost-mask", at("mask.exr")});
  const Image<float> shares = read_map(at("mask.exr")).map.rgb;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) ASSERT_NEAR(shares(x, y, 0), codes(x, y, 1) / 255.0, 1e-3);
  }
}

TEST_F(DeghostCommand, LeavesWhatIsStillAsItIs) {
  const MovingScene scene = moving_scene(MoverPlan{});
  write_shots(scene.still, "still");
  const std::vector<std::string> line = {"merge", at("still"), "-o", at("plain.exr"), "--response", "srgb"};
  answer_of(line);
  const Json answer = answer_of(
      {"merge", at("still"), "-o", at("clean.exr"), "--response", "srgb", "--deghost", "--ghost-mask", at("mask.png")});
  EXPECT_EQ(answer["deghost"]["share"], 0);
  EXPECT_TRUE(std::filesystem::exists(at("mask.png"))) << "black, but there";
  const Image<float> plain = read_map(at("plain.exr")).map.rgb, clean = read_map(at("clean.exr")).map.rgb;
  for (int y = 0; y < plain.height(); ++y) {
    for (int k = 0; k < 3 * plain.width(); ++k) ASSERT_EQ(plain.row(y)[k], clean.row(y)[k]);
  }
}

TEST_F(DeghostCommand, AThingThatFillsAShotIsNotAnotherScene) {
  MoverPlan plan;
  plan.object = 0.9;
  plan.step = 0.02;
  MovingScene scene = moving_scene(plan);
  // One shot shows something else altogether.
  plan.seed = 7;
  MovingScene other = moving_scene(plan);
  scene.still.shots[2] = std::move(other.moving.shots[2]);
  write_shots(scene.still, "passing");
  answer_of({"merge", at("passing"), "-o", at("map.exr"), "--response", "srgb", "--align", "none", "--deghost"});
}

TEST_F(DeghostCommand, AMaskWithoutItIsAMisuse) {
  write_shots(moving_scene(MoverPlan{}).still, "still");
  const CommandResult result = run_hdr({"merge", at("still"), "-o", at("map.exr"), "--ghost-mask", at("mask.png")});
  EXPECT_EQ(result.exit_code, 2) << result.err;
}

}  // namespace
}  // namespace hdr::test
