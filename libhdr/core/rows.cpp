#include "libhdr/core/rows.h"

#include <algorithm>

namespace hdr {
namespace {

class RowsInMemory final : public PhotoRows {
 public:
  explicit RowsInMemory(const Photo& photo) : photo_(photo) {}

  Size size() const override { return photo_.size(); }
  CodesView rows(int first, int last) override {
    return std::visit([&](const auto& image) -> CodesView { return image.view().rows(first, last); }, photo_.codes);
  }

 private:
  const Photo& photo_;
};

template <class Code>
Image<Code> all_rows(PhotoRows& rows) {
  constexpr int kRowsAtATime = 16;  // they are still in the cache when they are copied
  Image<Code> codes(rows.size(), 3);
  for (int y = 0; y < codes.height(); y += kRowsAtATime) {
    const int last = std::min(codes.height(), y + kRowsAtATime);
    const auto band = std::get<View<const Code>>(rows.rows(y, last));
    for (int k = 0; k < last - y; ++k) std::copy_n(band.row(k), codes.row_samples(), codes.row(y + k));
  }
  return codes;
}

}  // namespace

std::unique_ptr<PhotoRows> rows_of(const Photo& photo) {
  if (!photo.in_memory() && photo.source.open) return photo.source.open();
  return std::make_unique<RowsInMemory>(photo);
}

LoadedShot::LoadedShot(const Photo& photo) : photo_(&photo) {
  if (photo.in_memory() || !photo.source.open) return;
  decoded_ = std::make_unique<Photo>(Photo{photo.path, photo.exposure, photo.bits, photo.lossy, {}, {}, {}});
  const std::unique_ptr<PhotoRows> rows = photo.source.open();
  if (photo.bits <= 8) {
    decoded_->codes = all_rows<std::uint8_t>(*rows);
  } else {
    decoded_->codes = all_rows<std::uint16_t>(*rows);
  }
  photo_ = decoded_.get();
}

}  // namespace hdr
