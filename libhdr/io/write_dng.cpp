#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <memory>

#include "libhdr/core/error.h"
#include "libhdr/io/dng.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/output_file.h"

namespace hdr {
namespace {

// What libtiff's headers have no names for: TIFF/EP (ISO 12234-2) and DNG 1.4.
constexpr std::uint16_t kPhotometricCfa = 32803, kIlluminantD65 = 21;

struct Close {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};

/// CIE XYZ to the camera's colours: for want of the sensor's own, IEC 61966-2-1 (sRGB), D65.
constexpr std::array<float, 9> kSrgbFromXyz = {3.2404542f, -1.5371385f, -0.4985314f, -0.9692660f, 1.8760108f,
                                               0.0415560f, 0.0556434f,  -0.2040259f, 1.0572252f};

void set_picture_tags(TIFF* tiff, const Mosaic& mosaic) {
  TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, 0);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, mosaic.codes.width());
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, mosaic.codes.height());
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, mosaic.codes.height());
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, kPhotometricCfa);
}

void set_raw_tags(TIFF* tiff, const Mosaic& mosaic, const std::string& camera) {
  static constexpr std::uint8_t kVersion[4] = {1, 4, 0, 0}, kReadableBy[4] = {1, 1, 0, 0}, kPlanes[3] = {0, 1, 2};
  static constexpr std::uint16_t kTwoByTwo[2] = {2, 2};
  TIFFSetField(tiff, TIFFTAG_DNGVERSION, kVersion);
  TIFFSetField(tiff, TIFFTAG_DNGBACKWARDVERSION, kReadableBy);
  TIFFSetField(tiff, TIFFTAG_UNIQUECAMERAMODEL, camera.c_str());
  TIFFSetField(tiff, TIFFTAG_MODEL, camera.c_str());
  std::array<std::uint8_t, 4> pattern{};
  std::array<float, 4> black{};
  for (std::size_t k = 0; k < 4; ++k) {
    pattern[k] = static_cast<std::uint8_t>(cfa_channel(mosaic.cfa, static_cast<int>(k % 2), static_cast<int>(k / 2)));
    black[k] = static_cast<float>(mosaic.black_level[k]);
  }
  TIFFSetField(tiff, TIFFTAG_CFAREPEATPATTERNDIM, kTwoByTwo);
  TIFFSetField(tiff, TIFFTAG_CFAPATTERN, 4, pattern.data());
  TIFFSetField(tiff, TIFFTAG_CFAPLANECOLOR, 3, kPlanes);
  TIFFSetField(tiff, TIFFTAG_CFALAYOUT, 1);  // a rectangle
  TIFFSetField(tiff, TIFFTAG_BLACKLEVELREPEATDIM, kTwoByTwo);
  TIFFSetField(tiff, TIFFTAG_BLACKLEVEL, 4, black.data());
  const auto white = static_cast<std::uint32_t>(std::lround(mosaic.white_level));
  TIFFSetField(tiff, TIFFTAG_WHITELEVEL, 1, &white);
  static constexpr std::array<float, 3> kNeutral = {1, 1, 1};
  TIFFSetField(tiff, TIFFTAG_COLORMATRIX1, 9, kSrgbFromXyz.data());
  TIFFSetField(tiff, TIFFTAG_CALIBRATIONILLUMINANT1, kIlluminantD65);
  TIFFSetField(tiff, TIFFTAG_ASSHOTNEUTRAL, 3, kNeutral.data());
}

}  // namespace

void write_dng(const Path& path, const Mosaic& mosaic, const std::string& camera) {
  HDR_ASSERT(mosaic.cfa != Cfa::kNone && mosaic.codes.channels() == 1 && !mosaic.codes.empty());
  if (internal::extension_of(path) != ".dng") {
    throw Error(path.string() + ": cannot be written: a raw photograph is a DNG file; write .dng");
  }
  OutputFile out(path);
  {
    const std::unique_ptr<TIFF, Close> tiff(TIFFOpen(out.temporary().c_str(), "wl"));  // little endian, as our EXIF
    if (!tiff) internal::throw_unwritable(path, "libtiff cannot open it");
    set_picture_tags(tiff.get(), mosaic);
    set_raw_tags(tiff.get(), mosaic, camera.empty() ? "unknown camera" : camera);
    Image<std::uint16_t> row(mosaic.codes.width(), 1, 1);  // libtiff may swap bytes in place
    for (int y = 0; y < mosaic.codes.height(); ++y) {
      std::copy_n(mosaic.codes.row(y), mosaic.codes.width(), row.row(0));
      if (TIFFWriteScanline(tiff.get(), row.row(0), static_cast<std::uint32_t>(y)) != 1) {
        internal::throw_unwritable(path, "the pixels did not fit");
      }
    }
    if (TIFFFlush(tiff.get()) != 1) internal::throw_unwritable(path, "the pixels did not fit");
  }
  internal::embed_exif(out.temporary(), mosaic.exposure);
  out.commit();
}

}  // namespace hdr
