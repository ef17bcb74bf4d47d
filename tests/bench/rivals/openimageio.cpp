#include "tests/bench/rivals/openimageio.h"

#include <OpenImageIO/imageio.h>

#include "libhdr/core/error.h"

namespace hdr::bench {

Image<float> read_by_oiio(const Path& path) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) throw Error(OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  Image<float> image(spec.width, spec.height, spec.nchannels);
  const auto step = static_cast<OIIO::stride_t>(sizeof(float));
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.row(0), step * spec.nchannels,
                         step * image.stride())) {
    throw Error(input->geterror());
  }
  return image;
}

void write_by_oiio(const Path& path, View<const float> map, bool half, const std::string& compression) {
  OIIO::ImageSpec spec(map.width(), map.height(), 3, half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
  if (!compression.empty()) spec.attribute("compression", compression);
  const auto output = OIIO::ImageOutput::create(path.string());
  if (!output) throw Error(OIIO::geterror());
  const auto step = static_cast<OIIO::stride_t>(sizeof(float));
  if (!output->open(path.string(), spec) ||
      !output->write_image(OIIO::TypeDesc::FLOAT, map.row(0), 3 * step, step * map.stride()) || !output->close()) {
    throw Error(output->geterror());
  }
}

}  // namespace hdr::bench
