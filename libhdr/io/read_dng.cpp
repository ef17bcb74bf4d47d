#include <fmt/format.h>
#include <libraw/libraw.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <utility>

#include "libhdr/core/error.h"
#include "libhdr/io/demosaic.h"
#include "libhdr/io/dng.h"
#include "libhdr/io/internal/dng_file.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/internal/oiio.h"

namespace hdr {
namespace {

void require(int libraw_error, const Path& path) {
  if (libraw_error == LIBRAW_SUCCESS) return;
  const char* reason = libraw_error > 0 ? std::strerror(libraw_error) : libraw_strerror(libraw_error);
  throw Error(fmt::format("{}: cannot be read: {}; is it damaged?", path.string(), reason));
}

std::optional<Cfa> cfa_of(LibRaw& raw) {
  for (const Cfa cfa : {Cfa::kRggb, Cfa::kBggr, Cfa::kGrbg, Cfa::kGbrg}) {
    bool same = true;
    for (int k = 0; k < 4; ++k) {
      const int colour = raw.COLOR(k / 2, k % 2);  // the second green may be a fourth colour
      same &= (colour == 3 ? 1 : colour) == cfa_channel(cfa, k % 2, k / 2);
    }
    if (same) return cfa;
  }
  return std::nullopt;
}

/// A file that was opened, its header read.
std::unique_ptr<LibRaw> opened(const Path& path) {
  if (std::error_code failed; !std::filesystem::exists(path, failed)) {
    throw Error(path.string() + ": no such file; check the name");
  }
  auto raw = std::make_unique<LibRaw>();
  require(raw->open_file(path.c_str()), path);
  const libraw_iparams_t& what = raw->imgdata.idata;
  constexpr unsigned kOddPattern = 1000;  // LibRaw's numbers below are other sensors'
  if (what.filters < kOddPattern || what.colors != 3 || std::strcmp(what.cdesc, "RGBG") != 0 || !cfa_of(*raw)) {
    throw Error(path.string() + ": has no Bayer pattern; develop it with a raw converter into a 16-bit TIFF");
  }
  return raw;
}

Exposure exposure_of(const LibRaw& raw) {
  const libraw_imgother_t& shot = raw.imgdata.other;
  const auto number = [](float value) {
    return value > 0 ? std::optional(internal::number_from_exif_float(value)) : std::nullopt;
  };
  return {number(shot.shutter), number(shot.aperture), number(shot.iso_speed), 0};
}

/// DNG 1.4, "Mapping Raw Values to Linear Reference Values": one level, one for each colour, or a repeated pattern.
double black_level(const LibRaw& raw, int colour, int x, int y) {
  const libraw_colordata_t& levels = raw.imgdata.color;
  double black = levels.black + levels.cblack[colour];
  const int rows = static_cast<int>(levels.cblack[4]), columns = static_cast<int>(levels.cblack[5]);
  if (rows > 0 && columns > 0) black += levels.cblack[6 + (y % rows) * columns + x % columns];
  return black;
}

Mosaic mosaic_of(LibRaw& raw, const Path& path) {
  require(raw.unpack(), path);
  const libraw_image_sizes_t& sizes = raw.imgdata.sizes;
  const std::uint16_t* all = raw.imgdata.rawdata.raw_image;
  if (!all) throw Error(path.string() + ": has no 16-bit mosaic; develop it with a raw converter into a 16-bit TIFF");
  Mosaic mosaic;
  mosaic.codes = Image<std::uint16_t>(sizes.width, sizes.height, 1);
  const auto stride = static_cast<std::ptrdiff_t>(sizes.raw_pitch / sizeof(std::uint16_t));
  for (int y = 0; y < sizes.height; ++y) {
    std::copy_n(all + (y + sizes.top_margin) * stride + sizes.left_margin, sizes.width, mosaic.codes.row(y));
  }
  mosaic.cfa = cfa_of(raw).value();
  for (int k = 0; k < 4; ++k) {
    mosaic.black_level[static_cast<std::size_t>(k)] = black_level(raw, raw.COLOR(k / 2, k % 2), k % 2, k / 2);
  }
  mosaic.white_level = raw.imgdata.color.maximum;
  mosaic.exposure = exposure_of(raw);
  return mosaic;
}

/// LibRaw's turns as EXIF orientations.
int orientation_of_flip(int flip) {
  switch (flip) {
    case 3:
      return 3;
    case 5:
      return 8;
    case 6:
      return 6;
    default:
      return 1;
  }
}

class RawInput final : public OIIO::ImageInput {
 public:
  explicit RawInput(Path path) : path_(std::move(path)), raw_(opened(path_)) {
    const libraw_image_sizes_t& sizes = raw_->imgdata.sizes;
    m_spec = OIIO::ImageSpec(sizes.width, sizes.height, 3, OIIO::TypeDesc::UINT16);
    m_spec.attribute("Orientation", orientation_of_flip(sizes.flip));
    m_spec.attribute("compression", "none");
    const libraw_imgother_t& shot = raw_->imgdata.other;
    if (shot.shutter != 0) m_spec.attribute("ExposureTime", shot.shutter);
    if (shot.aperture > 0) m_spec.attribute("FNumber", shot.aperture);
    if (shot.iso_speed > 0) m_spec.attribute("Exif:PhotographicSensitivity", shot.iso_speed);
  }
  const char* format_name() const override { return internal::extension_of(path_) == ".dng" ? "dng" : "raw"; }
  bool open(const std::string&, OIIO::ImageSpec& spec) override {
    spec = m_spec;
    return true;
  }
  bool close() override { return true; }
  bool read_native_scanline(int, int, int y, int, void* data) override {
    if (!photo_.in_memory()) {
      photo_ = demosaic(mosaic_of(*raw_, path_));
      raw_.reset();
    }
    const auto& codes = std::get<Image<std::uint16_t>>(photo_.codes);
    std::memcpy(data, codes.row(y), codes.row_samples() * sizeof(std::uint16_t));
    return true;
  }

 private:
  Path path_;
  std::unique_ptr<LibRaw> raw_;  ///< until the pixels are wanted
  Photo photo_;
};

}  // namespace

Mosaic read_dng(const Path& path) {
  return mosaic_of(*opened(path), path);
}

namespace internal {

bool is_raw_name(const Path& path) {
  static constexpr std::array kExtensions = {".dng", ".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".srf", ".sr2",
                                             ".orf", ".rw2", ".raf", ".pef", ".srw", ".3fr", ".iiq", ".mrw", ".kdc"};
  const std::string extension = extension_of(path);
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::shared_ptr<OIIO::ImageInput> open_raw(const Path& path) {
  return std::make_shared<RawInput>(path);
}

}  // namespace internal
}  // namespace hdr
