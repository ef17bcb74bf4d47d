// The cheap question, whether a pair has moved at all: never wrong about what moved, seldom undecided about what did
// not.
#include "libhdr/align/internal/still.h"

#include <gtest/gtest.h>

#include <atomic>

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
      const Photo &p = made.bracket.shots[k], &q = made.bracket.shots[k + 1];
      internal::StillProbe a(p, samples_of(p), linearizer), b(q, samples_of(q), linearizer);
      internal::StillPair pair(a, b);
      pair.ask_few();
      const internal::StillAnswer& answer = pair.ask_all();
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
    const Photo& photo = made.bracket.shots[0];
    internal::StillProbe probe(photo, samples_of(photo), linearizer);
    EXPECT_EQ(probe.most_tiles(), most);
  }
}

// Shots that are not in memory are decoded when something moved, and only then.
TEST(Still, ABracketThatLiesStillIsNotDecodedAgain) {
  for (const double shift : {0.0, 6.0}) {
    test::SimulationOptions options;
    options.size = {600, 400};
    options.shots = 4;
    options.scene_stops = 6;
    options.largest_shift = shift;
    test::SimulatedBracket made = test::simulate(options, 5);
    const Alignment in_memory = align(made.bracket, srgb_response(8));
    std::vector<Photo> whole;
    std::atomic<int> decoded = 0;
    for (Photo& shot : made.bracket.shots) {
      whole.push_back({shot.path, shot.exposure, shot.bits, shot.lossy, std::move(shot.codes), {}, {}});
    }
    for (std::size_t k = 0; k < whole.size(); ++k) {
      Photo& shot = made.bracket.shots[k];
      shot.codes = Image<std::uint8_t>();
      shot.source = {whole[k].size(), [&, k] {
                       ++decoded;
                       return rows_of(whole[k]);
                     }};
      shot.samples = samples_of(whole[k]);
    }
    const Alignment streamed = align(made.bracket, srgb_response(8));
    EXPECT_EQ(decoded == 0, shift == 0) << decoded << " decoded, moved by up to " << shift << " px";
    for (std::size_t k = 0; k < whole.size(); ++k) {
      EXPECT_EQ(streamed.frames[k].ref_from_photo, in_memory.frames[k].ref_from_photo) << "shot " << k;
      EXPECT_EQ(streamed.frames[k].residual_px, in_memory.frames[k].residual_px) << "shot " << k;
    }
  }
}

}  // namespace
}  // namespace hdr
