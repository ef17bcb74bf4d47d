#include "tests/bench/decode_and_write.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenImageIO/imageio.h>
#include <half.h>

#include <algorithm>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"

namespace hdr::bench {
namespace {

Image<std::uint8_t> decoded(const Path& path) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) throw Error(path.string() + ": cannot be read: " + OIIO::geterror());
  Image<std::uint8_t> codes(input->spec().width, input->spec().height, 3);
  if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, codes.row(0), 3, codes.stride())) {
    throw Error(path.string() + ": cannot be read: " + input->geterror());
  }
  return codes;
}

void write_half_piz(const Image<float>& map, const Path& output) {
  Image<half> halves(map.size(), 3);
  for_rows(map.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      std::transform(map.row(y), map.row(y) + map.row_samples(), halves.row(y), [](float v) { return half(v); });
    }
  });
  Imf::Header header(map.width(), map.height());
  header.compression() = Imf::PIZ_COMPRESSION;
  Imf::FrameBuffer frame;
  const char* names[] = {"R", "G", "B"};
  for (int c = 0; c < 3; ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::HALF));
    frame.insert(names[c], Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves.row(0) + c), 3 * sizeof(half),
                                      sizeof(half) * static_cast<std::size_t>(halves.stride())));
  }
  Imf::OutputFile out(output.c_str(), header, threads());
  out.setFrameBuffer(frame);
  out.writePixels(map.height());
}

}  // namespace

void decode_and_write(const std::vector<Path>& shots, const Image<float>& map, const Path& output) {
  std::vector<Image<std::uint8_t>> codes(shots.size());
  for_rows(static_cast<int>(shots.size()), 1, [&](int first, int) {
    codes[static_cast<std::size_t>(first)] = decoded(shots[static_cast<std::size_t>(first)]);
  });
  write_half_piz(map, output);
}

}  // namespace hdr::bench
