#include "tests/camera/uvc/sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/camera/uvc/scene.h"

namespace hdr::sim {
namespace {

constexpr float kFullWellElectrons = 8000, kReadNoiseElectrons = 3;

/// [IEC 61966-2-1] from linear light in [0, 1] to [0, 255], through a table: powers are slow on an emulated processor.
float srgb_code(float light) {
  static const std::vector<float> table = [] {
    std::vector<float> codes(4097);
    for (std::size_t i = 0; i < codes.size(); ++i) {
      const double v = static_cast<double>(i) / 4096;
      codes[i] = static_cast<float>(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055));
    }
    return codes;
  }();
  const float at = light * 4096;
  const auto below = std::min<std::size_t>(static_cast<std::size_t>(at), 4095);
  return table[below] + (at - static_cast<float>(below)) * (table[below + 1] - table[below]);
}

std::uint8_t byte(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f)));
}

/// Two pixels of BT.601 4:2:2, limited range, from R'G'B' in [0, 255].
std::array<std::uint8_t, 4> yuyv_pair(const std::array<float, 3>& a, const std::array<float, 3>& b, float brightness) {
  const auto luma = [&](const std::array<float, 3>& c) {
    return byte(16 + 0.2568f * c[0] + 0.5041f * c[1] + 0.0979f * c[2] + brightness);
  };
  const float red = (a[0] + b[0]) / 2, green = (a[1] + b[1]) / 2, blue = (a[2] + b[2]) / 2;
  return {luma(a), byte(128 - 0.1482f * red - 0.2910f * green + 0.4392f * blue), luma(b),
          byte(128 + 0.4392f * red - 0.3678f * green - 0.0714f * blue)};
}

/// A tile of noise is drawn for each patch and repeated over it: fresh in each frame, cheap enough for 30 frames a
/// second on an emulated processor. Even, so that it holds whole Bayer cells and 4:2:2 pairs.
constexpr int kTile = 16;

int bits_per_pixel(Encoding encoding) {
  switch (encoding) {
    case Encoding::kYuyv:
    case Encoding::kBayer16:
      return 16;
    case Encoding::kBayer10Packed:
      return 10;
    case Encoding::kGrey8:
      break;
  }
  return 8;
}

}  // namespace

std::size_t picture_bytes(Encoding encoding, int width, int height) {
  return static_cast<std::size_t>(width) * height * bits_per_pixel(encoding) / 8;
}

Settings Sensor::expose(double interval_seconds) {
  if (settings.auto_exposure) settings.exposure_100us = 100;  // a fixed scene: the meter has settled long ago
  on_the_way_.push_back(settings);
  while (static_cast<int>(on_the_way_.size()) > options_.latency + 1) on_the_way_.pop_front();
  used_ = on_the_way_.front();
  if (!used_.dynamic_frame_rate) {
    used_.exposure_100us = std::min(used_.exposure_100us, static_cast<std::uint32_t>(interval_seconds * 1e4));
  }
  return used_;
}

float Sensor::sense(float radiance) {
  float signal = radiance * static_cast<float>(used_.exposure_100us) * 1e-2f;
  const float gain = static_cast<float>(used_.gain_16ths) / 16;
  if (options_.noise) {
    std::normal_distribution<float> normal;
    const float electrons = signal * kFullWellElectrons;
    const float deviation = std::sqrt(electrons + kReadNoiseElectrons * kReadNoiseElectrons);
    signal = (electrons + deviation * normal(random_)) / kFullWellElectrons;
  }
  return signal * gain;
}

void Sensor::encode_patch(Encoding encoding, int column, int row, int width, int height,
                          std::vector<std::uint8_t>& out) {
  const int x0 = (column * width + kPatchColumns - 1) / kPatchColumns;
  const int x1 = ((column + 1) * width + kPatchColumns - 1) / kPatchColumns;
  const int y0 = (row * height + kPatchRows - 1) / kPatchRows;
  const int y1 = ((row + 1) * height + kPatchRows - 1) / kPatchRows;
  std::array<float, 3> light = patch_radiance(column, row);
  if (!used_.auto_white_balance) {
    light[0] *= 4600.0f / used_.white_balance_kelvin;
    light[2] *= used_.white_balance_kelvin / 4600.0f;
  }
  const int bits = bits_per_pixel(encoding);
  const std::size_t stride = static_cast<std::size_t>(width) * bits / 8, tile_bytes = kTile * bits / 8;
  for (int ty = 0; ty < kTile; ++ty) {
    std::array<std::uint8_t, kTile * 2> tile{};
    std::uint8_t* to = tile.data();
    const auto unit = [&](int channel) { return std::clamp(sense(light[channel]), 0.0f, 1.0f); };
    const auto bayer = [&](int tx, float white) {  // RGGB
      const float signal = sense(light[(tx & 1) + (ty & 1)]) * (1 - static_cast<float>(kBayerBlack));
      return static_cast<unsigned>(
          std::lround(white * std::clamp(static_cast<float>(kBayerBlack) + signal, 0.0f, 1.0f)));
    };
    for (int tx = 0; tx < kTile;) {
      switch (encoding) {
        case Encoding::kYuyv: {
          std::array<float, 3> a, b;
          for (int k = 0; k < 3; ++k) {
            a[k] = srgb_code(unit(k));
            b[k] = srgb_code(unit(k));
          }
          to = std::ranges::copy(yuyv_pair(a, b, static_cast<float>(used_.brightness) / 2 - 64), to).out;
          tx += 2;
          break;
        }
        case Encoding::kBayer10Packed: {  // four high bytes, then the low bits of the four
          unsigned low = 0;
          for (int k = 0; k < 4; ++k) {
            const unsigned code = bayer(tx + k, 1023);
            *to++ = static_cast<std::uint8_t>(code >> 2);
            low |= (code & 3) << (2 * k);
          }
          *to++ = static_cast<std::uint8_t>(low);
          tx += 4;
          break;
        }
        case Encoding::kBayer16: {
          const unsigned code = bayer(tx, 65535);
          *to++ = static_cast<std::uint8_t>(code);
          *to++ = static_cast<std::uint8_t>(code >> 8);
          tx += 1;
          break;
        }
        case Encoding::kGrey8:
          *to++ = byte(255 * unit(1));
          tx += 1;
          break;
      }
    }
    const std::size_t from = static_cast<std::size_t>(x0) * bits / 8, end = static_cast<std::size_t>(x1) * bits / 8;
    for (int y = y0 + ty; y < y1; y += kTile) {
      for (std::size_t at = from; at < end; at += tile_bytes) {
        std::copy_n(tile.begin(), std::min(tile_bytes, end - at),
                    out.begin() + static_cast<std::ptrdiff_t>(y * stride + at));
      }
    }
  }
}

std::vector<std::uint8_t> Sensor::picture(Encoding encoding, int width, int height) {
  std::vector<std::uint8_t> out(picture_bytes(encoding, width, height));
  for (int row = 0; row < kPatchRows; ++row) {
    for (int column = 0; column < kPatchColumns; ++column) encode_patch(encoding, column, row, width, height, out);
  }
  return out;
}

}  // namespace hdr::sim
