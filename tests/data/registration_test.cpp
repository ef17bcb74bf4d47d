// Registration of real photographs, for which no truth is known: what it says of three shots must agree with itself.
#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/align/align.h"
#include "libhdr/io/bracket.h"
#include "libhdr/response/calibrate.h"
#include "tests/support/support.h"

namespace hdr {
namespace {

/// b_from_a, measured on two shots alone.
Mat3 motion_between(const Path& a, const Path& b, Size& size) {
  const Bracket bracket = read_bracket({a, b});
  size = bracket.size();
  const Alignment found = align(bracket, provisional_response(bracket));
  const std::size_t of_a = bracket.shots[0].path.filename() == a.filename() ? 0 : 1;
  for (const FrameAlignment& frame : found.frames) {
    EXPECT_EQ(frame.skipped, "") << a << " and " << b;
    EXPECT_GT(frame.inliers, 0.8) << a << " and " << b;
    EXPECT_LT(frame.residual_px, 0.1) << a << " and " << b;
  }
  return found.frames[1 - of_a].ref_from_photo.inverse() * found.frames[of_a].ref_from_photo;
}

// One may see by eye that the shots are 15 and 25 px apart, and turned; the way around all three must lead back.
// Measured pair by pair, each on its own, it does within .22 px; the camera was carried, and near and far moved
// differently.
TEST(Registration, AroundThreeHandHeldShotsAndBack) {
  HDR_NEED_SHARED_DATA(folder, "brackets/t2i_handheld");
  const Path a = folder / "IMG_4209.jpg", b = folder / "IMG_4210.jpg", c = folder / "IMG_4211.jpg";
  Size size;
  const Mat3 b_from_a = motion_between(a, b, size), c_from_b = motion_between(b, c, size);
  const Mat3 around = motion_between(a, c, size).inverse() * c_from_b * b_from_a;
  double squares = 0, farthest = 0, moved = 0;
  for (int k = 0; k < 35; ++k) {
    const Vec3 p((k % 5) * (size.width - 1) / 4.0, (k / 5) * (size.height - 1) / 6.0, 1);
    const double off = ((around * p).hnormalized() - p.head<2>()).norm();
    squares += off * off / 35;
    farthest = std::max(farthest, off);
    moved = std::max(moved, ((b_from_a * p).hnormalized() - p.head<2>()).norm());
  }
  EXPECT_GT(moved, 10) << "the shots are far apart; no answer near 0 can be right";
  EXPECT_LT(std::sqrt(squares), 0.3) << "px, root mean square over the picture";
  EXPECT_LT(farthest, 1.0) << "px, in its farthest corner";
}

// On a stand that held; and film scans, which are deformed by more than they are shifted: a motion would mend nothing.
TEST(Registration, ShotsFromAStandAndScansStay) {
  for (const char* name : {"brackets/canon5d_15", "brackets/memorial"}) {
    HDR_NEED_SHARED_DATA(folder, name);
    BracketOptions options;
    if (std::string(name).ends_with("memorial")) options.exposures = folder / "image_list.txt";
    const Bracket bracket = read_bracket({folder}, options);
    const Alignment found = align(bracket, provisional_response(bracket));
    EXPECT_TRUE(found.identity()) << name;
    for (std::size_t k = 0; k < found.frames.size(); ++k) {
      EXPECT_FALSE(found.frames[k].skipped.empty()) << name;
      if (static_cast<int>(k) <= found.reference) continue;
      EXPECT_LT(found.frames[k].residual_px, 1)
          << name << ": the merge would leave it out; " << found.frames[k].skipped;
    }
  }
}

}  // namespace
}  // namespace hdr
