// Pictures for surfaces, through OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "libhdr/core/color.h"
#include "libhdr/core/parallel.h"
#include "libhdr/render/texture.h"

namespace hdr {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& fact) {
  throw Error(fmt::format("{}: {}; give the texture as PNG or JPEG", name, fact));
}

Texture decoded(OIIO::ImageInput& input, TextureMeaning meaning, const std::string& name) {
  const OIIO::ImageSpec& spec = input.spec();
  constexpr int kLargest = 32768;
  if (spec.width < 1 || spec.height < 1 || spec.width > kLargest || spec.height > kLargest || spec.nchannels < 1)
    refuse(name, fmt::format("is {} x {} texels", spec.width, spec.height));
  Texture texture;
  texture.texels = Image<float>(spec.width, spec.height, 3);
  const int stored = std::min(spec.nchannels, 4);
  Image<float> samples(spec.width, spec.height, stored);
  const auto sample = static_cast<OIIO::stride_t>(sizeof(float));
  if (!input.read_image(0, 0, 0, stored, OIIO::TypeDesc::FLOAT, samples.row(0), stored * sample,
                        samples.stride() * sample))
    refuse(name, "is damaged: " + input.geterror());
  const bool codes = spec.format.basetype != OIIO::TypeDesc::FLOAT && spec.format.basetype != OIIO::TypeDesc::HALF;
  const bool srgb = codes && meaning == TextureMeaning::kColor;
  for_rows(spec.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < spec.width; ++x) {
        for (int c = 0; c < 3; ++c) {
          const float value = samples(x, y, stored < 3 ? 0 : c);  // grey, or grey with alpha
          texture.texels(x, y, c) = srgb ? static_cast<float>(linear_from_srgb(value)) : std::max(0.0f, value);
        }
      }
    }
  });
  return texture;
}

}  // namespace

Texture read_texture(const Path& path, TextureMeaning meaning) {
  const std::string name = path.string();
  if (!std::filesystem::is_regular_file(path)) throw Error(name + ": no such texture; put it where the scene names it");
  const auto input = OIIO::ImageInput::open(name);
  if (!input) {
    OIIO::geterror();
    refuse(name, "is not a picture that can be read");
  }
  return decoded(*input, meaning, name);
}

Texture texture_from_bytes(std::span<const unsigned char> file, TextureMeaning meaning, const std::string& name) {
  // OpenImageIO chooses the reader by the name's extension: what the first bytes say it is.
  const bool png = file.size() > 4 && file[0] == 0x89 && file[1] == 'P', jpeg = file.size() > 4 && file[0] == 0xff;
  if (!png && !jpeg) refuse(name, "is neither PNG nor JPEG");
  OIIO::Filesystem::IOMemReader memory(
      OIIO::cspan<unsigned char>(file.data(), static_cast<std::ptrdiff_t>(file.size())));
  const auto input = OIIO::ImageInput::open(png ? "texture.png" : "texture.jpg", nullptr, &memory);
  if (!input) {
    OIIO::geterror();
    refuse(name, "is damaged");
  }
  return decoded(*input, meaning, name);
}

}  // namespace hdr
