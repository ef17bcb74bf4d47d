// Real photographs through the chain: no error, no NaN, and a map that explains the shots.
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

namespace fs = std::filesystem;

struct Set {
  const char* name;
  const char* folder;
  std::vector<std::string> options;
  double least_stops;  ///< range the merged map must have at least: more than any one of its shots
};

void PrintTo(const Set& set, std::ostream* out) {
  *out << set.name;
}

class RealBracket : public ::testing::TestWithParam<Set> {};

TEST_P(RealBracket, MergesWithoutErrorOrNaN) {
  const Set& set = GetParam();
  HDR_NEED_SHARED_DATA(folder, set.folder);
  const ScratchDir scratch;
  const std::string out = (scratch / "map.exr").string();
  std::vector<std::string> arguments = {"merge", folder.string(), "-o", out};
  for (std::string option : set.options) {
    if (option == "LIST") option = (folder / "image_list.txt").string();
    if (option == "DETAIL") option = (folder / "detail.txt").string();
    arguments.push_back(option);
  }
  const Json answer = answer_of(arguments);
  EXPECT_GE(answer["stops"].get<double>(), set.least_stops);
  EXPECT_TRUE(answer["converged"].get<bool>());
  int used = 0;
  for (const Json& frame : answer["frames"]) used += frame["used"].get<bool>();
  EXPECT_GE(used, 2);
  const Json info = answer_of({"info", out})["files"][0];
  EXPECT_EQ(info["nan"], 0);
  EXPECT_EQ(info["inf"], 0);
  EXPECT_EQ(info["negative"], 0);
  EXPECT_EQ(info["width"], answer["width"]);
}

INSTANTIATE_TEST_SUITE_P(
    Sets, RealBracket,
    ::testing::Values(Set{"t2i_tripod", "brackets/t2i_tripod", {}, 10},
                      Set{"t2i_handheld", "brackets/t2i_handheld", {}, 7},
                      Set{"canon5d_15", "brackets/canon5d_15", {}, 9},
                      Set{"iphone6_window", "brackets/iphone6_window", {"--exposures", "DETAIL"}, 7},
                      Set{"stlouis_arch", "brackets/stlouis_arch/images/st_louis", {}, 8},
                      Set{"memorial", "brackets/memorial", {"--exposures", "LIST"}, 14}),
    [](const auto& set) { return std::string(set.param.name); });

TEST(RealBall, KartikBecomesAProbe) {
  HDR_NEED_SHARED_DATA(folder, "mirrorball/kartik_3exp/Materials");
  const ScratchDir scratch;
  const std::string out = (scratch / "probe.exr").string();
  const Json answer =
      answer_of({"probe", (folder / "10.JPG").string(), (folder / "40.JPG").string(), (folder / "160.JPG").string(),
                 "--times", "1/10,1/40,1/160", "--ball", "242,229,228", "-o", out, "--width", "512"});
  EXPECT_EQ(answer["frames"].size(), 3u);
  const Json info = answer_of({"info", out})["files"][0];
  EXPECT_EQ(info["width"], 512);
  EXPECT_EQ(info["nan"], 0);
  EXPECT_GT(info["max"].get<double>(), 0);
  const Json sh = answer_of({"sh", out});
  EXPECT_GT(sh["coefficients"][0][1].get<double>(), 0);
}

}  // namespace
}  // namespace hdr::test
