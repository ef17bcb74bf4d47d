#include <fmt/format.h>

#include <algorithm>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/rec709.h"
#include "libhdr/io/internal/tiff_file.h"
#include "libhdr/io/internal/write_own.h"

namespace hdr::internal {
namespace {

/// libtiff's Pixar encoder has 11 bits a sample: steps of 0.4 % from e^-4 = 0.018 up to here, equal ones of 7e-5 below.
constexpr float kPixarLargest = 24.2f;

class LogTiffOut final : public RowsOut {
 public:
  LogTiffOut(const Path& file, const Path& path, const MapHeader& header, const std::string& compression)
      : path_(path),
        file_(file, "w"),
        pixar_(compression == "pixarlog"),
        grey_(compression == "logl"),
        xyz_from_rgb_(xyz_matrix(header.chromaticities)) {
    TIFF* tiff = file_.get();
    if (!tiff) throw_unwritable(path, file_.complaint());
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, header.size.width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, header.size.height);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, grey_ ? 1 : 3);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 32);
    TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    if (pixar_) {
      TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_PIXARLOG);
      TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
      TIFFSetField(tiff, TIFFTAG_PIXARLOGDATAFMT, PIXARLOGDATAFMT_FLOAT);
    } else {
      TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression == "logluv24" ? COMPRESSION_SGILOG24 : COMPRESSION_SGILOG);
      TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, grey_ ? PHOTOMETRIC_LOGL : PHOTOMETRIC_LOGLUV);
      TIFFSetField(tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT);
      if (header.white_luminance) TIFFSetField(tiff, TIFFTAG_STONITS, *header.white_luminance);
    }
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, TIFFDefaultStripSize(tiff, 0));
  }

  void put(View<float> rows) override {
    for (int y = 0; y < rows.height(); ++y) {
      float* row = rows.row(y);
      if (pixar_) {
        count_misfits(row, rows.width());
      } else {
        to_xyz(row, rows.width());
      }
      if (TIFFWriteScanline(file_.get(), row, static_cast<std::uint32_t>(done_++)) != 1) {
        throw_unwritable(path_, file_.complaint());
      }
    }
  }
  void finish() override {
    if (misfits_ > 0) {
      throw Error(
          fmt::format("{}: cannot be written: {} pixels exceed the largest that Pixar's log holds, {} (the largest is "
                      "{:g}); write .exr, or --compression logluv",
                      path_.string(), misfits_, kPixarLargest, largest_));
    }
    if (!file_.close()) throw_unwritable(path_, file_.complaint());
  }

 private:
  void count_misfits(const float* row, int width) {
    for (int x = 0; x < width; ++x) {
      const float largest = std::max({row[3 * x], row[3 * x + 1], row[3 * x + 2]});
      if (!(largest <= kPixarLargest)) ++misfits_;
      largest_ = std::max(largest_, largest);
    }
  }
  /// In place: XYZ, or Y alone.
  void to_xyz(float* row, int width) const {
    for (int x = 0; x < width; ++x) {
      const Vec3 xyz = xyz_from_rgb_ * Vec3(row[3 * x], row[3 * x + 1], row[3 * x + 2]);
      if (grey_) {
        row[x] = static_cast<float>(xyz.y());
      } else {
        for (int c = 0; c < 3; ++c) row[3 * x + c] = static_cast<float>(xyz[c]);
      }
    }
  }

  Path path_;
  TiffFile file_;
  bool pixar_, grey_;
  Mat3 xyz_from_rgb_;
  int done_ = 0;
  std::int64_t misfits_ = 0;
  float largest_ = 0;
};

}  // namespace

bool is_log_compression(const std::string& compression) {
  return compression == "pixarlog" || compression == "logluv" || compression == "logluv24" || compression == "logl";
}

std::unique_ptr<RowsOut> write_log_tiff(const Path& file, const Path& path, const MapHeader& header,
                                        const std::string& compression) {
  return std::make_unique<LogTiffOut>(file, path, header, compression);
}

}  // namespace hdr::internal
