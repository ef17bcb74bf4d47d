// Memory follows the picture's size, not the number of shots.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/cli/fixture.h"
#include "tests/cli/peak_memory.h"

namespace hdr::test {
namespace {

std::string times(int shots) {
  std::string list;
  for (int k = 0; k < shots; ++k) {
    if (k > 0) list.push_back(',');
    list.append(std::to_string(std::exp2(0.5 * (k - 0.5 * shots)) / 30));
  }
  return list;
}

void simulate(const std::filesystem::path& world, const std::filesystem::path& folder, int shots, const char* size) {
  ASSERT_EQ(run_hdr({"simulate", world, "-o", folder, "--times", times(shots), "--size", size, "--quiet"}).exit_code,
            0);
}

// 2.5 times the float map (12 bytes a pixel), whatever the number of shots; what the program and its libraries take
// without any picture to speak of is not counted.
TEST(Memory, OfAMergeFollowsItsMapAndNotTheShots) {
  const ScratchDir folder;
  write_world(folder / "world.exr");
  simulate(folder / "world.exr", folder / "small", 16, "64x48");
  simulate(folder / "world.exr", folder / "many", 16, "2000x1500");
  const auto merge = [&](const char* shots) {
    return peak_mb({"merge", folder / shots, "-o", folder / "map.exr", "--quiet", "--threads", "2"});
  };
  // Which buffers of the decoders meet depends on the threads' timing: some megabytes from run to run. The least of a
  // few runs is what the merge needs.
  const double without = merge("small");
  double with = merge("many");
  for (int again = 0; again < 3; ++again) with = std::min(with, merge("many"));
  const double map_mb = 2000.0 * 1500 * 12 / (1 << 20);
  EXPECT_LE(with - without, 2.5 * map_mb) << "16 shots; the float map takes " << map_mb << " MB, the program alone "
                                          << without << " MB, the merge " << with << " MB";
}

}  // namespace
}  // namespace hdr::test
