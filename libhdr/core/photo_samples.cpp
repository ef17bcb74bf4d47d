#include "libhdr/core/photo_samples.h"

#include <algorithm>

namespace hdr {
namespace {

constexpr double kFewest = 1 << 16;  // pixels of the lattice: a quantile is then known to 0.2 %
constexpr int kSide = PhotoSamples::kTileSide;

int lattice_step(Size size) {
  const double pixels = 1.0 * size.width * size.height;
  int step = 1;
  while (pixels / (4.0 * step * step) >= kFewest && 2 * step <= std::min(size.width, size.height)) step *= 2;
  return step;
}

/// Takes what it needs from the rows that pass by: from top to bottom, none left out, in bands of any height.
template <class Code>
class Sampler {
 public:
  explicit Sampler(Size size)
      : size_(size), step_(lattice_step(size)), lattice_(size.width / step_, size.height / step_, 3) {
    constexpr int kTiles = PhotoSamples::kTiles;
    if (std::min(size.width, size.height) >= kTiles * kSide) tiles_ = Image<Code>(kTiles * kSide, kTiles * kSide, 3);
  }

  void look_at(const View<const Code>& band, int first) {
    const int last = first + band.height();
    const auto next = [&](int y) { return (y - step_ / 2 + step_ - 1) / step_; };  // the first lattice row from y on
    for (int v = std::max(0, next(first)); v < std::min(lattice_.height(), next(last)); ++v) {
      const Code* from = band.pixel(step_ / 2, v * step_ + step_ / 2 - first);
      Code* to = lattice_.row(v);
      for (int u = 0; u < lattice_.width(); ++u, from += 3 * step_, to += 3) std::copy_n(from, 3, to);
    }
    for (int row = 0; row < tiles_.height(); ++row) {
      const int y = tile_corner(row / kSide, PhotoSamples::kTiles, size_.height) + row % kSide;
      if (y < first || y >= last) continue;
      for (int k = 0; k < PhotoSamples::kTiles; ++k) {
        const int x = tile_corner(k, PhotoSamples::kTiles, size_.width);
        std::copy_n(band.pixel(x, y - first), 3 * kSide, tiles_.pixel(k * kSide, row));
      }
    }
  }

  PhotoSamples finish() && { return {size_, step_, std::move(lattice_), std::move(tiles_)}; }

 private:
  Size size_;
  int step_;
  Image<Code> lattice_, tiles_;
};

template <class Code>
PhotoSamples sampled(PhotoRows& rows) {
  constexpr int kRowsAtATime = 16;
  const Size size = rows.size();
  Sampler<Code> sampler(size);
  for (int y = 0; y < size.height; y += kRowsAtATime) {
    const int last = std::min(size.height, y + kRowsAtATime);
    sampler.look_at(std::get<View<const Code>>(rows.rows(y, last)), y);
  }
  return std::move(sampler).finish();
}

}  // namespace

int tile_corner(int k, int n, int length) {
  return static_cast<int>((k + 0.5) / n * (length - kSide));
}

Codes cut_tiles(const Codes& photo, int tiles) {
  const auto cut = [&](const auto& codes) -> Codes {
    auto mosaic = std::remove_cvref_t<decltype(codes)>(tiles * kSide, tiles * kSide, 3);
    for (int row = 0; row < mosaic.height(); ++row) {
      const int y = tile_corner(row / kSide, tiles, codes.height()) + row % kSide;
      for (int k = 0; k < tiles; ++k) {
        std::copy_n(codes.pixel(tile_corner(k, tiles, codes.width()), y), 3 * kSide, mosaic.pixel(k * kSide, row));
      }
    }
    return mosaic;
  };
  return std::visit(cut, photo);
}

PhotoSamples sample_rows(PhotoRows& rows, int bits) {
  return bits <= 8 ? sampled<std::uint8_t>(rows) : sampled<std::uint16_t>(rows);
}

std::shared_ptr<const PhotoSamples> samples_of(const Photo& photo) {
  if (photo.samples) return photo.samples;
  const std::unique_ptr<PhotoRows> rows = rows_of(photo);
  return std::make_shared<const PhotoSamples>(sample_rows(*rows, photo.bits));
}

}  // namespace hdr
