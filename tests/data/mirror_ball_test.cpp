// Real photographs of mirror balls, enlarged snapshots and a slide: where the eye puts their outlines.
#include "libhdr/io/read.h"
#include "libhdr/probe/find_ball.h"
#include "tests/cli/fixture.h"

namespace hdr::test {
namespace {

struct Photograph {
  const char* file;
  Disc disc;         ///< by eye
  double within_px;  ///< what the eye and the blur leave
};

void PrintTo(const Photograph& p, std::ostream* out) {
  *out << p.file;
}

class RealBall : public ::testing::TestWithParam<Photograph> {};

TEST_P(RealBall, IsFoundWhereTheEyeSeesIt) {
  const Photograph& p = GetParam();
  HDR_NEED_SHARED_DATA(file, p.file);
  const auto found = find_ball(read_map(file).map.rgb);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->ball.disc.cx, p.disc.cx, p.within_px);
  EXPECT_NEAR(found->ball.disc.cy, p.disc.cy, p.within_px);
  EXPECT_NEAR(found->ball.disc.r, p.disc.r, p.within_px);
}

INSTANTIATE_TEST_SUITE_P(
    Photographs, RealBall,
    ::testing::Values(Photograph{"mirrorball/single_photos/gene_miller.jpg", {777, 530, 214.5}, 4},
                      Photograph{"mirrorball/kartik_3exp/Materials/40.JPG", {246, 230, 230}, 12}));

TEST(RealDome, OnAWallIsNoBall) {
  HDR_NEED_SHARED_DATA(file, "mirrorball/single_photos/postbank.jpg");
  EXPECT_FALSE(find_ball(read_map(file).map.rgb));
}

}  // namespace
}  // namespace hdr::test
