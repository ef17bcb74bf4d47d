#include <fmt/format.h>

#include <bit>
#include <fstream>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/write_own.h"

namespace hdr::internal {
namespace {

class PfmOut final : public RowsOut {
 public:
  PfmOut(const Path& file, const Path& path, const MapHeader& header, bool grey)
      : path_(path), out_(file, std::ios::binary), height_(header.size.height), grey_(grey) {
    static_assert(std::endian::native == std::endian::little);
    // The picture as it is for readers that do not look at the scale; whiteLuminance has no place in a PFM.
    out_ << fmt::format("{}\n{} {}\n-1.0\n", grey ? "Pf" : "PF", header.size.width, header.size.height);
    pixels_at_ = out_.tellp();
  }
  void put(View<float> rows) override {
    const int channels = grey_ ? 1 : 3;
    const auto bytes = static_cast<std::streamoff>(sizeof(float)) * channels * rows.width();
    for (int y = 0; y < rows.height(); ++y, ++done_) {
      float* row = rows.row(y);
      for (int x = 0; grey_ && x < rows.width(); ++x) {
        row[x] = static_cast<float>(luminance<double>(row[3 * x], row[3 * x + 1], row[3 * x + 2]));
      }
      out_.seekp(pixels_at_ + bytes * (height_ - 1 - done_));  // rows run from the bottom to the top
      out_.write(reinterpret_cast<const char*>(row), bytes);
    }
  }
  void finish() override {
    out_.close();
    if (!out_) throw_unwritable(path_, "the pixels did not fit");
  }

 private:
  Path path_;
  std::ofstream out_;
  std::streamoff pixels_at_ = 0;
  int height_, done_ = 0;
  bool grey_;
};

}  // namespace

std::unique_ptr<RowsOut> write_pfm(const Path& file, const Path& path, const MapHeader& header, bool grey) {
  return std::make_unique<PfmOut>(file, path, header, grey);
}

}  // namespace hdr::internal
