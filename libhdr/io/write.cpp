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
#include "libhdr/io/internal/write_exr.h"
#include "libhdr/io/output_file.h"

namespace hdr {
namespace {

std::string extension_of(const Path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}
bool is_jpeg(const std::string& extension) {
  return extension == ".jpg" || extension == ".jpeg";
}
bool is_tiff(const std::string& extension) {
  return extension == ".tif" || extension == ".tiff";
}

[[noreturn]] void throw_unwritable(const Path& path, const std::string& message) {
  throw Error(fmt::format("{}: cannot be written: {}; check the name and the space on the disk", path.string(),
                          internal::oiio_message(message, path)));
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

/// RGBE [Ward91] holds three 8-bit mantissas under the exponent of the largest. OpenImageIO cuts what does not fit,
/// which darkens by up to 1/256; so the values are first rounded to those that fit exactly.
Image<float> rounded_to_rgbe(const Image<float>& rgb, const Path& path) {
  Image<float> rounded(rgb.size(), 3);
  constexpr double kLargest = 0x1.fep126;  // mantissa 255/256, exponent 2^127
  for_rows(rgb.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < rgb.width(); ++x) {
        const float* from = rgb.pixel(x, y);
        const double largest = std::max({from[0], from[1], from[2]});
        if (!(largest <= kLargest)) {
          throw Error(
              fmt::format("{}: cannot be written: the value {:g} is beyond RGBE; write .exr", path.string(), largest));
        }
        int exponent = 0;
        if (std::frexp(largest, &exponent) > 255.5 / 256) ++exponent;  // would round up to 256
        const double quantum = std::ldexp(1.0, exponent - 8);
        for (int c = 0; c < 3; ++c) rounded(x, y, c) = static_cast<float>(std::round(from[c] / quantum) * quantum);
      }
    }
  });
  return rounded;
}

void write_hdr(const Path& file, const Path& path, const RadianceMap& map) {
  const Image<float> rounded = rounded_to_rgbe(map.rgb, path);
  write_pixels(file, path, spec_of(rounded.view(), 3), rounded.view());
}

}  // namespace

void write_map(const Path& path, const RadianceMap& map, const Provenance& provenance, const WriteOptions& options) {
  HDR_ASSERT(!map.rgb.empty() && map.rgb.channels() == 3);
  const std::string extension = extension_of(path);
  const bool known = extension == ".exr" || extension == ".hdr" || is_tiff(extension);
  if (is_jpeg(extension) || extension == ".png") {
    throw Error(path.string() +
                ": cannot be written: a radiance map does not fit in a picture; write .exr, or make the "
                "picture with hdr tonemap");
  }
  if (!known) {
    throw Error(fmt::format("{}: cannot be written: no format for maps is called '{}'; write .exr, .hdr or .tif",
                            path.string(), extension));
  }
  OutputFile out(path);
  if (extension == ".exr") {
    internal::write_exr(out.temporary(), path, map, provenance, options);
  } else if (extension == ".hdr") {
    write_hdr(out.temporary(), path, map);
  } else {
    write_pixels<float>(out.temporary(), path, spec_of<float>(map.rgb.view(), 3), map.rgb.view());
  }
  out.commit();
}

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

void write_photo(const Path& path, const Photo& photo, int jpeg_quality) {
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
  internal::embed_exposure(out.temporary(), photo.exposure);
  out.commit();
}

}  // namespace hdr
