#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/write_exr.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/write.h"

namespace hdr {
namespace {

using internal::extension_of;
using internal::throw_unwritable;

void require_map_name(const Path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".jpg" || extension == ".jpeg" || extension == ".png") {
    throw Error(path.string() +
                ": cannot be written: a radiance map does not fit in a picture; write .exr, or make the "
                "picture with hdr tonemap");
  }
  if (extension != ".exr" && extension != ".hdr" && extension != ".tif" && extension != ".tiff") {
    throw Error(fmt::format("{}: cannot be written: no format for maps is called '{}'; write .exr, .hdr or .tif",
                            path.string(), extension));
  }
}

class ExrRows final : public MapWriter {
 public:
  ExrRows(const Path& path, const MapHeader& header, const Provenance& provenance, const WriteOptions& options)
      : file_(path), writer_(file_.temporary(), path, header, false, provenance, options) {}

  void put(const MapRows& rows) override {
    HDR_ASSERT(rows.first == next_);
    next_ += rows.rgb.height();
    writer_.put({rows.rgb, {}, rows.stddev, rows.flags});
  }
  void finish() override {
    writer_.finish();
    file_.commit();
  }

 private:
  OutputFile file_;
  internal::ExrWriter writer_;
  int next_ = 0;
};

/// RGBE [Ward91] holds three 8-bit mantissas under the exponent of the largest. OpenImageIO cuts what does not fit,
/// which darkens by up to 1/256; so the values are first rounded to those that fit exactly.
void round_to_rgbe(View<float> rgb, const Path& path) {
  constexpr double kLargest = 0x1.fep126;  // mantissa 255/256, exponent 2^127
  for_rows(rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < rgb.width(); ++x) {
        float* pixel = rgb.pixel(x, y);
        const double largest = std::max({pixel[0], pixel[1], pixel[2]});
        if (!(largest <= kLargest)) {
          throw Error(
              fmt::format("{}: cannot be written: the value {:g} is beyond RGBE; write .exr", path.string(), largest));
        }
        int exponent = 0;
        if (std::frexp(largest, &exponent) > 255.5 / 256) ++exponent;  // would round up to 256
        const double quantum = std::ldexp(1.0, exponent - 8);
        for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(std::round(pixel[c] / quantum) * quantum);
      }
    }
  });
}

/// Radiance HDR and float TIFF, through OpenImageIO.
class ScanlineRows final : public MapWriter {
 public:
  ScanlineRows(const Path& path, Size size)
      : path_(path), size_(size), file_(path), waiting_(size.width, std::min(size.height, kRowsAtATime), 3) {
    OIIO::ImageSpec spec(size.width, size.height, 3, OIIO::TypeDesc::FLOAT);
    spec.attribute("DateTime", "");  // TIFF would get the clock time: the same work gives the same bytes
    output_ = OIIO::ImageOutput::create(file_.temporary().string());
    if (!output_) throw_unwritable(path, OIIO::geterror());
    if (!output_->open(file_.temporary().string(), spec)) throw_unwritable(path, output_->geterror());
  }

  void put(const MapRows& rows) override {
    HDR_ASSERT(rows.first == first_ + count_ && rows.rgb.width() == size_.width);
    HDR_ASSERT(rows.first + rows.rgb.height() <= size_.height);
    for (int y = 0; y < rows.rgb.height(); ++y) {
      std::copy_n(rows.rgb.row(y), waiting_.row_samples(), waiting_.row(count_));
      if (++count_ == waiting_.height()) flush();
    }
  }
  void finish() override {
    if (count_ > 0) flush();
    HDR_ASSERT(first_ == size_.height);
    if (!output_->close()) throw_unwritable(path_, output_->geterror());
    file_.commit();
  }

 private:
  /// Strips of a TIFF are compressed whole; a multiple of OpenImageIO's 32 rows goes on to all threads.
  static constexpr int kRowsAtATime = 128;

  void flush() {
    const View<float> rows = waiting_.view().rows(0, count_);
    if (extension_of(path_) == ".hdr") round_to_rgbe(rows, path_);
    const auto sample = static_cast<OIIO::stride_t>(sizeof(float));
    const bool written = output_->write_scanlines(first_, first_ + count_, 0, OIIO::TypeDesc::FLOAT, rows.data(),
                                                  3 * sample, sample * rows.stride());
    if (!written) throw_unwritable(path_, output_->geterror());
    first_ += count_;
    count_ = 0;
  }

  Path path_;
  Size size_;
  OutputFile file_;
  std::unique_ptr<OIIO::ImageOutput> output_;
  Image<float> waiting_;
  int first_ = 0, count_ = 0;  ///< rows written, and rows that wait
};

MapHeader header_of(const RadianceMap& map) {
  return {map.size(), map.chromaticities, map.white_luminance, map.projection, !map.stddev.empty(), false};
}

}  // namespace

std::unique_ptr<MapWriter> open_map_rows(const Path& path, const MapHeader& header, const Provenance& provenance,
                                         const WriteOptions& options) {
  HDR_ASSERT(header.size.width > 0 && header.size.height > 0);
  require_map_name(path);
  if (extension_of(path) == ".exr") return std::make_unique<ExrRows>(path, header, provenance, options);
  return std::make_unique<ScanlineRows>(path, header.size);
}

void write_map(const Path& path, const RadianceMap& map, const Provenance& provenance, const WriteOptions& options) {
  HDR_ASSERT(!map.rgb.empty() && map.rgb.channels() == 3);
  if (extension_of(path) != ".exr" || map.alpha.empty()) {
    const auto writer = open_map_rows(path, header_of(map), provenance, options);
    writer->put({0, map.rgb, map.stddev, {}});
    return writer->finish();
  }
  OutputFile file(path);
  internal::ExrWriter writer(file.temporary(), path, header_of(map), true, provenance, options);
  writer.put({map.rgb, map.alpha, map.stddev, {}});
  writer.finish();
  file.commit();
}

}  // namespace hdr
