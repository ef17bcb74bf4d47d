#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/write_exr.h"
#include "libhdr/io/internal/write_own.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/write.h"
#include "libhdr/io/write_layers.h"

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
  static constexpr std::array kKnown = {".exr", ".hdr", ".pfm", ".tif", ".tiff"};
  if (std::find(kKnown.begin(), kKnown.end(), extension) == kKnown.end()) {
    throw Error(fmt::format("{}: cannot be written: no format for maps is called '{}'; write .exr, .hdr, .pfm or .tif",
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

/// Float TIFF, through OpenImageIO.
class TiffOut final : public internal::RowsOut {
 public:
  TiffOut(const Path& file, const Path& path, const MapHeader& header, const std::string& compression) : path_(path) {
    OIIO::ImageSpec spec(header.size.width, header.size.height, 3, OIIO::TypeDesc::FLOAT);
    spec.attribute("DateTime", "");  // TIFF would get the clock time: the same work gives the same bytes
    if (compression == "none" || compression == "lzw" || compression == "zip") {
      spec.attribute("compression", compression);
    }
    output_ = OIIO::ImageOutput::create(file.string());
    if (!output_) throw_unwritable(path, OIIO::geterror());
    if (!output_->open(file.string(), spec)) throw_unwritable(path, output_->geterror());
  }
  void put(View<float> rows) override {
    const auto sample = static_cast<OIIO::stride_t>(sizeof(float));
    const bool written = output_->write_scanlines(done_, done_ + rows.height(), 0, OIIO::TypeDesc::FLOAT, rows.data(),
                                                  3 * sample, sample * rows.stride());
    if (!written) throw_unwritable(path_, output_->geterror());
    done_ += rows.height();
  }
  void finish() override {
    if (!output_->close()) throw_unwritable(path_, output_->geterror());
  }

 private:
  Path path_;
  std::unique_ptr<OIIO::ImageOutput> output_;
  int done_ = 0;
};

std::unique_ptr<internal::RowsOut> rows_out(const Path& file, const Path& path, const MapHeader& header,
                                            const WriteOptions& options) {
  const std::string extension = extension_of(path);
  if (extension == ".hdr") return internal::write_radiance(file, path, header);
  if (extension == ".pfm") return internal::write_pfm(file, path, header, options.grey);
  if (internal::is_log_compression(options.compression)) {
    return internal::write_log_tiff(file, path, header, options.compression);
  }
  return std::make_unique<TiffOut>(file, path, header, options.compression);
}

/// Bands as they come become rows enough at a time for all threads.
class ScanlineRows final : public MapWriter {
 public:
  ScanlineRows(const Path& path, const MapHeader& header, const WriteOptions& options)
      : size_(header.size),
        file_(path),
        waiting_(size_.width, std::min(size_.height, kRowsAtATime), 3),
        out_(rows_out(file_.temporary(), path, header, options)) {}

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
    out_->finish();
    file_.commit();
  }

 private:
  /// Strips of a TIFF are compressed whole; a multiple of OpenImageIO's 32 rows goes on to all threads.
  static constexpr int kRowsAtATime = 128;

  void flush() {
    out_->put(waiting_.view().rows(0, count_));
    first_ += count_;
    count_ = 0;
  }

  Size size_;
  OutputFile file_;
  Image<float> waiting_;
  std::unique_ptr<internal::RowsOut> out_;
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
  return std::make_unique<ScanlineRows>(path, header, options);
}

void write_map(const Path& path, const RadianceMap& map, const Provenance& provenance, const WriteOptions& options) {
  HDR_ASSERT(!map.rgb.empty() && map.rgb.channels() == 3);
  if (extension_of(path) == ".exr" && !map.alpha.empty()) return write_layers(path, map, {}, provenance, options);
  const auto writer = open_map_rows(path, header_of(map), provenance, options);
  writer->put({0, map.rgb, map.stddev, {}});
  writer->finish();
}

void write_layers(const Path& path, const RadianceMap& map, std::span<const Layer> layers, const Provenance& provenance,
                  const WriteOptions& options) {
  HDR_ASSERT(!map.rgb.empty() && map.rgb.channels() == 3);
  if (extension_of(path) != ".exr")
    throw Error(path.string() + ": cannot be written: only EXR has layers; write .exr, or leave the layers out");
  std::vector<std::vector<std::string>> names;
  internal::ExrBand band{map.rgb, map.alpha, map.stddev, {}, {}};
  for (const Layer& layer : layers) {
    HDR_ASSERT(layer.samples.size() == map.size());
    HDR_ASSERT(layer.samples.channels() == static_cast<int>(layer.channels.size()));
    names.push_back(layer.channels);
    band.more.push_back(layer.samples);
  }
  OutputFile file(path);
  internal::ExrWriter writer(file.temporary(), path, header_of(map), !map.alpha.empty(), provenance, options, names);
  writer.put(band);
  writer.finish();
  file.commit();
}

}  // namespace hdr
