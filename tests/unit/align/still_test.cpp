// The cheap question, whether a pair has moved at all: never wrong about what moved, seldom undecided about what did
// not.
#include "libhdr/align/internal/still.h"

#include <gtest/gtest.h>

#include "tests/unit/align/simulated_bracket.h"

namespace hdr {
namespace {

TEST(Still, WhatMovesIsNotStillAndWhatIsStillIsFoundSo) {
  int still = 0, pairs = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    test::SimulationOptions options;
    options.size = {600, 400};
    options.shots = 5;
    options.scene_stops = 6;
    options.largest_shift = seed % 2 ? 0.5 : 0;
    const test::SimulatedBracket made = test::simulate(options, seed);
    const internal::Linearizer linearizer(srgb_response(8), 8, false);
    for (std::size_t k = 0; k + 1 < made.bracket.shots.size(); ++k) {
      internal::StillProbe a(LoadedShot(made.bracket.shots[k]), linearizer),
          b(LoadedShot(made.bracket.shots[k + 1]), linearizer);
      const internal::StillAnswer answer = internal::still_motion(a, b);
      const double moved = (made.scene_from_photo[k] - made.scene_from_photo[k + 1]).norm();
      if (moved > internal::kStillPx) {
        EXPECT_NE(answer.stillness, internal::Stillness::kStill) << "seed " << seed << " " << k << ": " << moved;
        continue;
      }
      ++pairs;
      still += answer.stillness == internal::Stillness::kStill;
    }
  }
  EXPECT_GE(pairs, 8);
  EXPECT_GE(still, 0.8 * pairs);
}

// What a few tiles do not tell, more of them do: the picture has no more than fit into it.
TEST(Still, TilesAreAsManyAsFit) {
  test::SimulationOptions options;
  options.largest_shift = 0;
  options.shots = 1;
  for (const auto& [size, most] : {std::pair(Size{400, 300}, 4), {Size{600, 130}, 2}, {Size{16, 16}, 0}}) {
    options.size = size;
    const test::SimulatedBracket made = test::simulate(options, 1);
    const internal::Linearizer linearizer(srgb_response(8), 8, false);
    internal::StillProbe probe(LoadedShot(made.bracket.shots[0]), linearizer);
    EXPECT_EQ(probe.most_tiles(), most);
  }
}

}  // namespace
}  // namespace hdr
