#include "libhdr/io/demosaic.h"

#include <fmt/format.h>
#include <libraw/libraw.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"

namespace hdr {
namespace {

constexpr int kWhite = 65535;

LibRaw_openbayer_patterns pattern_of(Cfa cfa) {
  switch (cfa) {
    case Cfa::kBggr:
      return LIBRAW_OPENBAYER_BGGR;
    case Cfa::kGrbg:
      return LIBRAW_OPENBAYER_GRBG;
    case Cfa::kGbrg:
      return LIBRAW_OPENBAYER_GBRG;
    case Cfa::kNone:
    case Cfa::kRggb:
      break;
  }
  return LIBRAW_OPENBAYER_RGGB;
}

/// A sample with black at 0 and white at 65535.
std::uint16_t scaled(const Mosaic& mosaic, int x, int y) {
  const double black = mosaic.black(x, y);
  const double share = (mosaic.codes(x, y) - black) / (mosaic.white_level - black);
  return static_cast<std::uint16_t>(std::lround(kWhite * std::clamp(share, 0.0, 1.0)));
}

/// All of them, without gaps between the rows, as LibRaw takes it. To DHT a zero is a sample that is missing, and it
/// interpolates nothing darker than the darkest that is there: zeros become ones.
std::vector<std::uint16_t> scaled_above_zero(const Mosaic& mosaic) {
  const int width = mosaic.codes.width(), height = mosaic.codes.height();
  std::vector<std::uint16_t> samples(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for_rows(height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      std::uint16_t* to = samples.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
      for (int x = 0; x < width; ++x) to[x] = std::max<std::uint16_t>(1, scaled(mosaic, x, y));
    }
  });
  return samples;
}

void require(int libraw_error) {
  if (libraw_error != LIBRAW_SUCCESS) {
    throw Error(
        fmt::format("raw picture: LibRaw cannot demosaic it: {}; write DNG instead", libraw_strerror(libraw_error)));
  }
}

/// LibRaw, told to interpolate and to do nothing else.
std::unique_ptr<LibRaw> interpolated(std::vector<std::uint16_t>& samples, Size size, Cfa cfa) {
  auto raw = std::make_unique<LibRaw>();
  constexpr int kDht = 11;
  libraw_output_params_t& params = raw->imgdata.params;
  params.user_qual = kDht;
  params.output_bps = 16;
  params.output_color = 0;  // the sensor's
  params.gamm[0] = params.gamm[1] = 1;
  params.no_auto_bright = 1;
  params.use_camera_wb = params.use_auto_wb = 0;
  std::fill(std::begin(params.user_mul), std::end(params.user_mul), 1.0f);
  params.adjust_maximum_thr = 0;
  params.user_black = 0;
  params.user_sat = kWhite;
  params.user_flip = 0;
  require(raw->open_bayer(reinterpret_cast<unsigned char*>(samples.data()),
                          static_cast<unsigned>(samples.size() * sizeof(std::uint16_t)),
                          static_cast<ushort>(size.width), static_cast<ushort>(size.height), 0, 0, 0, 0, 0,
                          static_cast<unsigned char>(pattern_of(cfa)), 0, 0, 0));
  require(raw->unpack());
  require(raw->dcraw_process());
  return raw;
}

}  // namespace

Photo demosaic(const Mosaic& mosaic) {
  const Size size = mosaic.codes.size();
  constexpr int kSmallest = 16, kLargest = 65535;  // DHT looks 4 pixels far; LibRaw counts in 16 bits
  if (std::min(size.width, size.height) < kSmallest || std::max(size.width, size.height) > kLargest) {
    throw Error(
        fmt::format("raw picture: {}x{} pixels; demosaicing takes 16x16 to 65535x65535", size.width, size.height));
  }
  for (const double black : mosaic.black_level) {
    if (black < mosaic.white_level) continue;
    throw Error(fmt::format("raw picture: white level {} is not above black level {}; check the camera's format",
                            mosaic.white_level, black));
  }
  HDR_ASSERT(mosaic.cfa != Cfa::kNone && mosaic.codes.channels() == 1);
  std::vector<std::uint16_t> samples = scaled_above_zero(mosaic);
  const auto raw = interpolated(samples, size, mosaic.cfa);
  HDR_ASSERT(raw->imgdata.sizes.iwidth == size.width && raw->imgdata.sizes.iheight == size.height);

  const auto sample = [&](int x, int y) {
    return samples[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x)];
  };
  Image<std::uint16_t> codes(size, 3);
  for_rows(size.height, 32, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const auto* colours = raw->imgdata.image + static_cast<std::ptrdiff_t>(y) * size.width;
      for (int x = 0; x < size.width; ++x) {
        std::uint16_t* rgb = codes.pixel(x, y);
        for (int c = 0; c < 3; ++c) rgb[c] = colours[x][c] == 1 ? 0 : colours[x][c];  // see scaled_above_zero()
        for (int ny = std::max(0, y - 1); ny <= std::min(size.height - 1, y + 1); ++ny) {
          for (int nx = std::max(0, x - 1); nx <= std::min(size.width - 1, x + 1); ++nx) {
            if (sample(nx, ny) == kWhite) rgb[cfa_channel(mosaic.cfa, nx, ny)] = kWhite;
          }
        }
        rgb[cfa_channel(mosaic.cfa, x, y)] = scaled(mosaic, x, y);  // what was seen stays as it was
      }
    }
  });
  return {{}, mosaic.exposure, 16, false, std::move(codes), {}};
}

}  // namespace hdr
