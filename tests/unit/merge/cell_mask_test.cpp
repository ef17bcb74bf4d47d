#include "libhdr/merge/internal/cell_mask.h"

#include <gtest/gtest.h>

#include <string>

namespace hdr::internal {
namespace {

CellMask mask_of(const std::vector<std::string>& rows) {
  CellMask mask({static_cast<int>(rows[0].size()), static_cast<int>(rows.size())});
  std::size_t cell = 0;
  for (const std::string& row : rows) {
    for (const char c : row) mask.set[cell++] = c == '#';
  }
  return mask;
}

std::string text_of(const CellMask& mask) {
  std::string text;
  for (std::size_t k = 0; k < mask.set.size(); ++k) {
    if (k % static_cast<std::size_t>(mask.size.width) == 0) text += '\n';
    text += mask.set[k] ? '#' : '.';
  }
  return text;
}

TEST(CellMask, GrowsBySquares) {
  EXPECT_EQ(text_of(dilated(mask_of({"......", "..#...", "......", "......"}), 1)), "\n.###..\n.###..\n.###..\n......");
}

TEST(CellMask, ClosesGapsAndKeepsWhatStandsAlone) {
  EXPECT_EQ(
      text_of(closed(mask_of({"..........", "..........", "..##..##..", "..##..##..", "..........", ".........."}), 1)),
      "\n..........\n..........\n..######..\n..######..\n..........\n..........");
  EXPECT_EQ(
      text_of(closed(
          mask_of({".........", ".........", "..#......", ".........", "......#..", ".........", "........."}), 1)),
      "\n.........\n.........\n..#......\n.........\n......#..\n.........\n.........");
}

TEST(CellMask, FillsHolesButNotBays) {
  EXPECT_EQ(text_of(filled(mask_of({"......", ".####.", ".#..#.", ".####.", ".#..#."}))),
            "\n......\n.####.\n.####.\n.####.\n.#..#.");
  EXPECT_EQ(text_of(filled(mask_of({".#.", "#.#", ".#."}))), "\n.#.\n###\n.#.") << "corners keep, too";
}

TEST(CellMask, PiecesAreInTheOrderOfTheirFirstCell) {
  const auto all = pieces(mask_of({"..#..", "#..#.", "#...."}));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].front(), 2);
  EXPECT_EQ(all[0].size(), 2u) << "joined at a corner";
  EXPECT_EQ(all[1].front(), 5);
}

TEST(CellMask, HysteresisKeepsPiecesThatHaveSeeds) {
  const std::vector<std::uint8_t> evidence = {3, 9, 3, 0, 3, 3, 0, 9,  //
                                              0, 3, 0, 0, 3, 0, 0, 0};
  EXPECT_EQ(text_of(hysteresis(evidence, evidence, {8, 2}, 3, 9, 1)), "\n###....#\n.#......");
  EXPECT_EQ(text_of(hysteresis(evidence, evidence, {8, 2}, 3, 9, 2)), "\n........\n........");
}

}  // namespace
}  // namespace hdr::internal
