// What is kept of a photograph is what the photograph shows, however its rows passed by.
#include "libhdr/core/photo_samples.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libhdr/core/random.h"

namespace hdr {
namespace {

template <class Code>
Photo noise_photo(Size size, int bits) {
  Image<Code> codes(size, 3);
  for (int y = 0; y < size.height; ++y) {
    Random random(3, static_cast<std::uint64_t>(y));
    for (std::size_t k = 0; k < codes.row_samples(); ++k) {
      codes.row(y)[k] = static_cast<Code>(random.uniform() * (1 << bits));
    }
  }
  Photo photo;
  photo.bits = bits;
  photo.codes = std::move(codes);
  return photo;
}

template <class Code>
void expect_samples(Size size, int bits, int step) {
  const Photo photo = noise_photo<Code>(size, bits);
  const auto taken = samples_of(photo);
  const PhotoSamples& samples = *taken;
  EXPECT_EQ(samples.photo, size);
  ASSERT_EQ(samples.step, step) << size.width << "x" << size.height;
  const auto& codes = std::get<Image<Code>>(photo.codes);
  const auto& lattice = std::get<Image<Code>>(samples.lattice);
  ASSERT_EQ(lattice.size(), (Size{size.width / step, size.height / step}));
  for (int y = 0; y < lattice.height(); ++y) {
    for (int x = 0; x < lattice.width(); ++x) {
      const Code* from = codes.pixel(step * x + step / 2, step * y + step / 2);
      ASSERT_TRUE(std::equal(from, from + 3, lattice.pixel(x, y))) << x << ", " << y;
    }
  }
  const auto& tiles = std::get<Image<Code>>(samples.tiles);
  constexpr int kTiles = PhotoSamples::kTiles, kSide = PhotoSamples::kTileSide;
  if (std::min(size.width, size.height) < kTiles * kSide) {
    EXPECT_TRUE(tiles.empty());
    return;
  }
  ASSERT_EQ(tiles.size(), (Size{kTiles * kSide, kTiles * kSide}));
  const Codes cut = cut_tiles(photo.codes, kTiles);
  for (int y = 0; y < tiles.height(); ++y) {
    for (int x = 0; x < tiles.width(); ++x) {
      const Code* from = codes.pixel(tile_corner(x / kSide, kTiles, size.width) + x % kSide,
                                     tile_corner(y / kSide, kTiles, size.height) + y % kSide);
      ASSERT_TRUE(std::equal(from, from + 3, tiles.pixel(x, y))) << x << ", " << y;
      ASSERT_TRUE(std::equal(from, from + 3, std::get<Image<Code>>(cut).pixel(x, y))) << x << ", " << y;
    }
  }
}

TEST(PhotoSamples, AreThePhotographsOwnPixels) {
  expect_samples<std::uint8_t>({400, 300}, 8, 1);
  expect_samples<std::uint8_t>({1001, 667}, 8, 2);
  expect_samples<std::uint16_t>({1600, 900}, 14, 4);
  expect_samples<std::uint8_t>({191, 500}, 8, 1);  // too narrow for the tiles
  expect_samples<std::uint8_t>({1, 1}, 8, 1);
  expect_samples<std::uint8_t>({3, 400000}, 8, 2);  // narrower than the step that its pixels would ask for
}

TEST(PhotoSamples, KeptOnesAreTakenForThoseOfThePhotograph) {
  Photo photo = noise_photo<std::uint8_t>({64, 64}, 8);
  const auto kept = samples_of(photo);
  photo.samples = kept;
  photo.codes = Image<std::uint8_t>();
  EXPECT_EQ(samples_of(photo), kept) << "no row is asked for";
}

}  // namespace
}  // namespace hdr
