// One scene or two? From codes alone.
#include "libhdr/io/internal/scene_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libhdr/core/random.h"
#include "tests/support/support.h"

namespace hdr::internal {
namespace {

/// A linear photograph of `scene`, moved by (dx, dy) pixels, noise of `noise` codes.
Photo photograph(const Image<float>& scene, double exposure, int dx = 0, int dy = 0, double noise = 1) {
  constexpr int kWidth = 320, kHeight = 240, kMargin = 40;
  Image<std::uint8_t> codes(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Random random(7, static_cast<std::uint64_t>(y * kWidth + x), static_cast<std::uint64_t>(1000 * exposure));
      for (int c = 0; c < 3; ++c) {
        const double level = scene(x + kMargin + dx, y + kMargin + dy, c) * exposure;
        const double code = 255 * std::pow(std::min(1.0, level), 1 / 2.2) + noise * random.normal();
        codes(x, y, c) = static_cast<std::uint8_t>(std::lround(std::clamp(code, 0.0, 255.0)));
      }
    }
  }
  Photo photo;
  photo.path = "shot" + std::to_string(exposure) + ".png";
  photo.codes = std::move(codes);
  return photo;
}

std::vector<Photo> bracket_of(const Image<float>& scene, const std::vector<double>& exposures) {
  std::vector<Photo> shots;
  for (const double exposure : exposures) shots.push_back(photograph(scene, exposure));
  return shots;
}

SceneThumbnail thumbnail(const Photo& photo) {
  return thumbnail_of(*samples_of(photo), photo.max_code());
}

std::string refusal(const std::vector<Photo>& shots) {
  std::vector<SceneThumbnail> thumbnails;
  for (const Photo& shot : shots) thumbnails.push_back(thumbnail(shot));
  return stranger_among(shots, thumbnails).value_or("");
}

TEST(SceneCheck, RanksAgreeAcrossExposuresAndHandShake) {
  const Image<float> scene = test::test_scene(400, 320, 8, 4);
  const SceneThumbnail a = thumbnail(photograph(scene, 0.2));
  EXPECT_GT(scene_agreement(a, thumbnail(photograph(scene, 0.8))).correlation, 0.97);
  EXPECT_GT(scene_agreement(a, thumbnail(photograph(scene, 0.8, 30, -22))).correlation, 0.9);
}

TEST(SceneCheck, TheStrangerIsNamedWhereverItStands) {
  const Image<float> here = test::test_scene(400, 320, 8, 4), tall = test::test_scene(320, 400, 8, 21);
  Image<float> there(400, 320, 3);
  for (int y = 0; y < 320; ++y) {
    for (int x = 0; x < 400; ++x) std::copy_n(tall.pixel(y, x), 3, there.pixel(x, y));
  }
  for (std::size_t stranger = 0; stranger < 5; ++stranger) {
    std::vector<Photo> shots;
    for (std::size_t k = 0; k < 5; ++k) shots.push_back(photograph(k == stranger ? there : here, std::exp2(k) / 16));
    const std::string message = refusal(shots);
    EXPECT_EQ(message.find(shots[stranger].path.string()), 0u) << stranger << ": " << message;
    shots.erase(shots.begin() + static_cast<std::ptrdiff_t>(stranger));
    EXPECT_EQ(refusal(shots), "");
  }
}

TEST(SceneCheck, FlatDarkAndMovingScenesPass) {
  // A grey wall: ranks are those of noise.
  Image<float> wall(400, 320, 3);
  for (int y = 0; y < 320; ++y) std::fill(wall.row(y), wall.row(y) + 1200, 0.2f);
  EXPECT_EQ(refusal(bracket_of(wall, {0.5, 1, 2})), "");
  // Too dark or too bright to compare.
  EXPECT_EQ(refusal(bracket_of(wall, {1e-6, 1, 1e6})), "");
  // A third of one shot is another thing.
  const Image<float> scene = test::test_scene(400, 320, 8, 4);
  std::vector<Photo> shots = bracket_of(scene, {0.25, 1, 4});
  auto& codes = std::get<0>(shots[1].codes);
  for (int y = 0; y < 240; ++y) {
    for (int x = 100; x < 200; ++x) std::fill_n(codes.pixel(x, y), 3, std::uint8_t{120});
  }
  EXPECT_EQ(refusal(shots), "");
}

TEST(SceneCheck, PicturesOfAnySizePass) {
  for (const Size size : {Size{1, 1}, Size{2, 2}, Size{65, 1}, Size{129, 67}}) {
    Photo photo;
    photo.codes = Image<std::uint8_t>(size, 3);
    EXPECT_EQ(refusal({}), "");
    std::vector<Photo> shots;
    for (int k = 0; k < 2; ++k) {
      Photo shot;
      shot.codes = std::get<0>(photo.codes).clone();
      shots.push_back(std::move(shot));
    }
    EXPECT_EQ(refusal(shots), "") << size.width << "x" << size.height;
  }
}

}  // namespace
}  // namespace hdr::internal
