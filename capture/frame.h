#pragma once
// What a camera hands over: bytes as the device wrote them, and all that is known of how they were exposed. develop.h
// turns them into a Photo.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "libhdr/core/image.h"
#include "libhdr/core/mosaic.h"

namespace hdr {

/// Sample layouts. Grey and Bayer samples of more than 8 bits are little-endian 16-bit words, in the low bits; the
/// packed ones are MIPI CSI-2's (4 samples in 5 bytes, 2 in 3), as V4L2 and libcamera have them.
enum class PixelFormat {
  kGrey8,
  kGrey10,
  kGrey12,
  kGrey16,
  kRgb8,   ///< interleaved, 3 bytes
  kRgb16,  ///< interleaved, 3 words
  kYuyv,   ///< BT.601 4:2:2
  kMjpeg,  ///< one JPEG file, `bytes` long
  kBayer8,
  kBayer10,
  kBayer12,
  kBayer16,
  kBayer10Packed,
  kBayer12Packed,
};

struct FrameFormat {
  PixelFormat pixels = PixelFormat::kRgb8;
  Cfa cfa = Cfa::kNone;
  Size size;
  std::ptrdiff_t stride_bytes = 0;  ///< between rows; 0 for kMjpeg
  bool full_range = false;          ///< kYuyv: luma runs over 0..255, not 16..235
  double black_level = 0;           ///< code that means no light
  double white_level = 255;         ///< code at which the sensor or its converter saturates

  bool operator==(const FrameFormat&) const = default;
};

/// "YUYV 640x480", "BGGR 10 bit packed 1640x1232".
std::string to_text(const FrameFormat& format);
/// 8 to 16: bits of a sample.
int bits_of(PixelFormat pixels);
bool is_bayer(PixelFormat pixels);
/// Bytes that a row of `width` pixels needs at least; 0 for kMjpeg, whose rows have no fixed length.
std::ptrdiff_t row_bytes_of(PixelFormat pixels, int width);

/// What decides a frame's exposure. Gain multiplies the signal; 1 is the device's least.
struct ExposureSetting {
  double seconds = 1.0 / 60;
  double gain = 1;

  double total() const { return seconds * gain; }
  bool operator==(const ExposureSetting&) const = default;
};

/// How the exposure of a frame is known.
enum class Verified {
  kNone,
  kBrightness,  ///< the picture changed as the asked exposure must change it, and two frames agree
  kMetadata,    ///< the device says with the frame itself what it was exposed with
};
const char* name_of(Verified verified);

struct Frame {
  std::span<const std::uint8_t> bytes;
  std::shared_ptr<const void>
      owner;        ///< keeps `bytes` alive; a device's buffer goes back to its queue with the last one
  int dmabuf = -1;  ///< file descriptor of the same memory where the device exports it, else -1
  FrameFormat format;
  std::uint32_t sequence = 0;            ///< the device's count: a gap is a lost frame
  std::chrono::nanoseconds timestamp{};  ///< of std::chrono::steady_clock
  ExposureSetting requested;             ///< the last set() when the frame arrived, as it was asked
  std::optional<ExposureSetting>
      reported;                         ///< by the device, with the frame itself; a control's read-back is no report
  Verified verified = Verified::kNone;  ///< decided by verify.h: cameras leave it alone
  std::optional<ExposureSetting> exposure;  ///< what it was taken with; present when it is verified

  /// Whether the bytes can hold the picture that the format promises. Of a compressed one nothing is known but that it
  /// is not empty.
  bool is_whole() const;
  /// Copies the bytes and lets the device's buffer go: a bracket's frames are kept longer than a camera has buffers.
  void detach();
};

}  // namespace hdr
