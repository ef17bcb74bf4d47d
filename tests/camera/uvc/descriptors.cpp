#include "tests/camera/uvc/descriptors.h"

#include <string>

namespace hdr::sim {
namespace {

constexpr std::uint8_t kInterface = 4, kEndpoint = 5, kAssociation = 11, kClassInterface = 0x24;
constexpr std::uint8_t kVideo = 14, kVideoControl = 1, kVideoStreaming = 2, kVideoCollection = 3;

/// Appends a descriptor: its length, its type, its content.
void append(Bytes& to, std::uint8_t type, const Bytes& content) {
  to.push_back(static_cast<std::uint8_t>(content.size() + 2));
  to.push_back(type);
  to.insert(to.end(), content.begin(), content.end());
}

/// Builds the content of a descriptor field by field.
struct Fields {
  Bytes bytes;
  Fields& u8(std::uint32_t v) {
    append_le(bytes, v, 1);
    return *this;
  }
  Fields& u16(std::uint32_t v) {
    append_le(bytes, v, 2);
    return *this;
  }
  Fields& u32(std::uint32_t v) {
    append_le(bytes, v, 4);
    return *this;
  }
  Fields& raw(const Bytes& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
    return *this;
  }
};

/// A format's GUID is its four-character code and the common end of [UVC 1.1 FAQ] media types.
Bytes guid(Encoding encoding) {
  std::string code;
  switch (encoding) {
    case Encoding::kYuyv:
      code = "YUY2";
      break;
    case Encoding::kBayer10Packed:
      code = "RW10";
      break;
    case Encoding::kBayer16:
      code = "RG16";
      break;
    case Encoding::kGrey8:
      code = "Y8  ";
      break;
  }
  code += std::string("\0\0\x10\0\x80\0\0\xaa\0\x38\x9b\x71", 12);
  return {code.begin(), code.end()};
}

Bytes control_interface(bool manual_exposure) {
  constexpr std::uint32_t kCamera = 0x0201, kStreamingTerminal = 0x0101;
  // Bits of the camera terminal: auto-exposure mode, priority, exposure time. Of the processing unit: brightness, white
  // balance temperature, gain, white balance auto.
  const std::uint32_t exposure = manual_exposure ? 0x0E : 0, processing = 0x1241;
  Bytes units;
  append(
      units, kClassInterface,
      Fields{}.u8(2).u8(kCameraTerminal).u16(kCamera).u8(0).u8(0).u16(0).u16(0).u16(0).u8(3).u8(exposure).u16(0).bytes);
  append(units, kClassInterface,
         Fields{}.u8(5).u8(kProcessingUnit).u8(kCameraTerminal).u16(0).u8(2).u16(processing).u8(0).u8(0).bytes);
  append(units, kClassInterface, Fields{}.u8(3).u8(3).u16(kStreamingTerminal).u8(0).u8(kProcessingUnit).u8(0).bytes);
  constexpr std::uint32_t kHeaderBytes = 13, kClockHz = 1'000'000;
  Bytes all;
  append(all, kClassInterface,
         Fields{}
             .u8(1)
             .u16(0x0110)
             .u16(kHeaderBytes + static_cast<std::uint32_t>(units.size()))
             .u32(kClockHz)
             .u8(1)
             .u8(1)
             .bytes);
  all.insert(all.end(), units.begin(), units.end());
  return all;
}

Bytes streaming_interface() {
  Bytes formats;
  for (std::size_t f = 0; f < kEncodings.size(); ++f) {
    const auto bits = static_cast<std::uint32_t>(picture_bytes(kEncodings[f], 8, 1));
    append(formats, kClassInterface,
           Fields{}
               .u8(4)
               .u8(static_cast<std::uint32_t>(f) + 1)
               .u8(kSizes.size())
               .raw(guid(kEncodings[f]))
               .u8(bits)
               .u8(1)
               .u32(0)
               .u8(0)
               .bytes);
    for (std::size_t s = 0; s < kSizes.size(); ++s) {
      const auto size = static_cast<std::uint32_t>(picture_bytes(kEncodings[f], kSizes[s].width, kSizes[s].height));
      Fields frame;
      frame.u8(5).u8(static_cast<std::uint32_t>(s) + 1).u8(0);
      frame.u16(static_cast<std::uint32_t>(kSizes[s].width)).u16(static_cast<std::uint32_t>(kSizes[s].height));
      frame.u32(size * 8 * 5).u32(size * 8 * 30).u32(size).u32(kIntervals[0]).u8(kIntervals.size());
      for (const std::uint32_t interval : kIntervals) frame.u32(interval);
      append(formats, kClassInterface, frame.bytes);
    }
    append(formats, kClassInterface, Fields{}.u8(0x0D).u8(1).u8(1).u8(4).bytes);  // colours: BT.709, sRGB, BT.601 luma
  }
  const std::uint32_t header = 13 + kEncodings.size();
  Fields input;
  input.u8(1).u8(kEncodings.size()).u16(header + static_cast<std::uint32_t>(formats.size())).u8(0x81);
  input.u8(0).u8(3).u8(0).u8(0).u8(0).u8(1);
  for (std::size_t f = 0; f < kEncodings.size(); ++f) input.u8(0);
  Bytes all;
  append(all, kClassInterface, input.bytes);
  all.insert(all.end(), formats.begin(), formats.end());
  return all;
}

}  // namespace

void append_le(Bytes& bytes, std::uint32_t value, int count) {
  for (int k = 0; k < count; ++k) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

Bytes device_descriptor() {
  Bytes bytes;
  append(bytes, 1,
         Fields{}
             .u16(0x0200)
             .u8(0xEF)
             .u8(2)
             .u8(1)
             .u8(64)
             .u16(0x1d6b)
             .u16(0x0102)
             .u16(0x0010)
             .u8(1)
             .u8(2)
             .u8(3)
             .u8(1)
             .bytes);
  return bytes;
}

Bytes configuration_descriptor(bool manual_exposure) {
  Bytes all;
  append(all, kAssociation, {0, 2, kVideo, kVideoCollection, 0, 2});
  append(all, kInterface, {0, 0, 0, kVideo, kVideoControl, 0, 2});
  const Bytes control = control_interface(manual_exposure);
  all.insert(all.end(), control.begin(), control.end());
  append(all, kInterface, {1, 0, 1, kVideo, kVideoStreaming, 0, 0});
  const Bytes streaming = streaming_interface();
  all.insert(all.end(), streaming.begin(), streaming.end());
  constexpr std::uint8_t kBulk = 2;
  append(all, kEndpoint, Fields{}.u8(0x81).u8(kBulk).u16(512).u8(0).bytes);
  constexpr std::uint32_t kHeaderBytes = 9;
  Bytes bytes;
  append(bytes, 2,
         Fields{}.u16(kHeaderBytes + static_cast<std::uint32_t>(all.size())).u8(2).u8(1).u8(0).u8(0x80).u8(250).bytes);
  bytes.insert(bytes.end(), all.begin(), all.end());
  return bytes;
}

Bytes device_qualifier() {
  return {10, 6, 0, 2, 0xEF, 2, 1, 64, 1, 0};
}

Bytes string_descriptor(int index) {
  if (index == 0) return {4, 3, 0x09, 0x04};  // US English
  const std::string texts[] = {"hdr", "UVC simulator", "0001"};
  Bytes content;
  for (const char c : texts[(index - 1) % 3]) append_le(content, static_cast<std::uint8_t>(c), 2);
  Bytes bytes;
  append(bytes, 3, content);
  return bytes;
}

}  // namespace hdr::sim
