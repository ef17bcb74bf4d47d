#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/io/internal/own_inputs.h"
#include "libhdr/io/internal/rec709.h"
#include "libhdr/io/internal/tiff_file.h"

namespace hdr::internal {
namespace {

/// Scanlines of floats from libtiff's own decoders: RGB (Pixar), XYZ (LogLuv) or Y (LogL).
class LogTiffInput final : public FloatRowsInput {
 public:
  LogTiffInput(const Path& path, std::unique_ptr<TiffFile> file) : name_(path.string()), file_(std::move(file)) {
    TIFF* tiff = file_->get();
    const auto compression = tiff_field<std::uint16_t>(tiff, TIFFTAG_COMPRESSION, 0);
    const auto photometric = tiff_field<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, 0);
    const auto width = tiff_field<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
    const auto height = tiff_field<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
    const auto samples = tiff_field<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    const bool pixar = compression == COMPRESSION_PIXARLOG;
    require_plain(width, height, samples, photometric);
    if (pixar) {
      TIFFSetField(tiff, TIFFTAG_PIXARLOGDATAFMT, PIXARLOGDATAFMT_FLOAT);
    } else {
      TIFFSetField(tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT);
    }
    m_spec = OIIO::ImageSpec(static_cast<int>(width), static_cast<int>(height), samples, OIIO::TypeDesc::FLOAT);
    if (samples == 1) m_spec.channelnames = {"Y"};
    m_spec.attribute("compression", pixar                                 ? "pixarlog"
                                    : photometric == PHOTOMETRIC_LOGL     ? "logl"
                                    : compression == COMPRESSION_SGILOG24 ? "logluv24"
                                                                          : "logluv");
    m_spec.attribute("Orientation", static_cast<int>(tiff_field<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, 1)));
    if (photometric == PHOTOMETRIC_LOGLUV) set_chromaticities(m_spec, kXyz);
    // Stonits: the luminance of 1.0, in cd/m^2.
    if (double stonits = 0; TIFFGetField(tiff, TIFFTAG_STONITS, &stonits) == 1 && stonits > 0) {
      m_spec.attribute("whiteLuminance", static_cast<float>(stonits));
    }
    if (TIFFScanlineSize(tiff) != static_cast<tmsize_t>(sizeof(float) * width * samples)) {
      throw Error(name_ + ": cannot be read: libtiff gives no float rows of it; is it damaged?");
    }
  }
  const char* format_name() const override { return "tiff"; }

 private:
  void require_plain(std::uint32_t width, std::uint32_t height, std::uint16_t samples, std::uint16_t photometric) {
    TIFF* tiff = file_->get();
    constexpr std::uint32_t kMost = 1 << 24;
    const bool grey = photometric == PHOTOMETRIC_LOGL || photometric == PHOTOMETRIC_MINISBLACK;
    const bool size = width >= 1 && height >= 1 && width <= kMost && height <= kMost;
    if (!size) throw Error(fmt::format("{}: has {} x {} pixels; is it damaged?", name_, width, height));
    const bool planes = tiff_field<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG, 1) != PLANARCONFIG_CONTIG && samples > 1;
    if (planes || TIFFIsTiled(tiff) || (samples != 3 && !(grey && samples == 1) && samples != 4)) {
      throw Error(
          fmt::format("{}: a log TIFF in {} with {} samples a pixel; only strips of RGB or grey are read: "
                      "convert it with tiffcp -s -p contig",
                      name_,
                      TIFFIsTiled(tiff) ? "tiles"
                      : planes          ? "planes"
                                        : "strips",
                      samples));
    }
  }

  void decode(int y, float* samples) override {
    if (y < next_ && TIFFSetDirectory(file_->get(), 0) != 1) fail(y);
    next_ = y + 1;
    if (TIFFReadScanline(file_->get(), samples, static_cast<std::uint32_t>(y)) != 1) fail(y);
  }
  [[noreturn]] void fail(int y) const {
    throw Error(fmt::format("{}: cannot be read after row {} of {}: {}; is it damaged?", name_, y, m_spec.height,
                            file_->complaint()));
  }

  std::string name_;
  std::unique_ptr<TiffFile> file_;
  int next_ = 0;
};

}  // namespace

std::shared_ptr<OIIO::ImageInput> open_log_tiff(const Path& path) {
  auto file = std::make_unique<TiffFile>(path, "r");
  if (!file->get()) return nullptr;  // OpenImageIO says why
  switch (tiff_field<std::uint16_t>(file->get(), TIFFTAG_COMPRESSION, 0)) {
    case COMPRESSION_PIXARLOG:
    case COMPRESSION_SGILOG:
    case COMPRESSION_SGILOG24:
      return std::make_shared<LogTiffInput>(path, std::move(file));
    default:
      return nullptr;
  }
}

}  // namespace hdr::internal
