#include "libhdr/io/write.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/rows.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/output_file.h"

namespace hdr {
namespace {

using internal::extension_of;
using internal::throw_unwritable;

bool is_jpeg(const std::string& extension) {
  return extension == ".jpg" || extension == ".jpeg";
}
bool is_tiff(const std::string& extension) {
  return extension == ".tif" || extension == ".tiff";
}

/// Writes the first spec.nchannels of each pixel of `pixels` into `file`, a temporary of `path`.
template <class T>
void write_pixels(const Path& file, const Path& path, OIIO::ImageSpec spec, View<const T> pixels) {
  spec.attribute("DateTime", "");  // TIFF would get the clock time: the same work gives the same bytes
  auto output = OIIO::ImageOutput::create(file.string());
  if (!output) throw_unwritable(path, OIIO::geterror());
  if (!output->open(file.string(), spec)) throw_unwritable(path, output->geterror());
  const auto sample = static_cast<OIIO::stride_t>(sizeof(T));
  const bool written = output->write_image(OIIO::TypeDesc(OIIO::BaseTypeFromC<T>::value), pixels.data(),
                                           sample * pixels.channels(), sample * pixels.stride());
  if (!written || !output->close()) throw_unwritable(path, output->geterror());
}

template <class T>
OIIO::ImageSpec spec_of(View<const T> pixels, int channels) {
  return {pixels.width(), pixels.height(), channels, OIIO::TypeDesc(OIIO::BaseTypeFromC<T>::value)};
}

/// What a camera writes: quality, chroma at half the resolution both ways.
void make_jpeg_like_a_camera(OIIO::ImageSpec& spec, int quality) {
  spec.attribute("compression", fmt::format("jpeg:{}", quality));
  spec.attribute("jpeg:subsampling", "4:2:0");
}

}  // namespace

void write_picture(const Path& path, View<const std::uint8_t> codes) {
  HDR_ASSERT(codes.channels() == 3 || codes.channels() == 4);
  const std::string extension = extension_of(path);
  if (!is_jpeg(extension) && extension != ".png") {
    throw Error(fmt::format("{}: cannot be written: '{}' is not a picture's extension; write .png or .jpg",
                            path.string(), extension));
  }
  OIIO::ImageSpec spec = spec_of(codes, is_jpeg(extension) ? 3 : codes.channels());
  spec.attribute("oiio:UnassociatedAlpha", 1);  // codes go into the file as they are
  constexpr int kFineQuality = 95;
  if (is_jpeg(extension)) make_jpeg_like_a_camera(spec, kFineQuality);
  OutputFile out(path);
  write_pixels(out.temporary(), path, spec, codes);
  out.commit();
}

void write_photo(const Path& path, const Photo& photo, int jpeg_quality, std::optional<double> fov_degrees) {
  const std::string extension = extension_of(path);
  if (!is_jpeg(extension) && extension != ".png" && !is_tiff(extension)) {
    throw Error(fmt::format("{}: cannot be written: '{}' is not a photograph's extension; write .jpg, .png or .tif",
                            path.string(), extension));
  }
  if (is_jpeg(extension) && photo.bits > 8) {
    throw Error(path.string() + ": cannot be written: JPEG holds 8 bits; write .png or .tif");
  }
  OutputFile out(path);
  const auto write_codes = [&](const auto& codes) {
    OIIO::ImageSpec spec = spec_of(codes.view(), 3);
    if (is_jpeg(extension)) make_jpeg_like_a_camera(spec, jpeg_quality);
    write_pixels(out.temporary(), path, spec, codes.view());
  };
  std::visit(write_codes, LoadedShot(photo)->codes);
  std::optional<internal::Lens> lens;
  if (fov_degrees) lens = {*fov_degrees, photo.size()};
  internal::embed_exif(out.temporary(), photo.exposure, lens);
  out.commit();
}

}  // namespace hdr
