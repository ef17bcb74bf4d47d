#pragma once
// Small files of meshes, made here: CI has no collection.
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "libhdr/core/vec.h"

namespace hdr::test {

inline void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline std::string big_endian(std::uint32_t x) {
  return {static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8), static_cast<char>(x)};
}

/// An RGB PNG of 8 bits, not compressed (one stored block: up to 65535 bytes).
inline std::string png(int width, int height, const std::vector<std::uint8_t>& rgb) {
  const auto crc = [](const std::string& text) {
    std::uint32_t c = ~0u;
    for (const char each : text) {
      c ^= static_cast<unsigned char>(each);
      for (int bit = 0; bit < 8; ++bit) c = (c >> 1) ^ ((c & 1) ? 0xedb88320u : 0u);
    }
    return ~c;
  };
  const auto chunk = [&](const std::string& type, const std::string& data) {
    return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(crc(type + data));
  };
  std::string rows;
  for (int y = 0; y < height; ++y) {
    rows += '\0';
    rows.append(reinterpret_cast<const char*>(rgb.data()) + 3 * width * y, static_cast<std::size_t>(3 * width));
  }
  std::uint32_t a = 1, b = 0;  // Adler-32
  for (const char each : rows) {
    a = (a + static_cast<unsigned char>(each)) % 65521;
    b = (b + a) % 65521;
  }
  const auto size = static_cast<std::uint32_t>(rows.size()), inverse = ~size;
  std::string stored = "\x78\x01\x01";
  stored += {static_cast<char>(size), static_cast<char>(size >> 8), static_cast<char>(inverse),
             static_cast<char>(inverse >> 8)};
  const std::string header = big_endian(static_cast<std::uint32_t>(width)) +
                             big_endian(static_cast<std::uint32_t>(height)) + std::string("\x08\x02\0\0\0", 5);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", stored + rows + big_endian((b << 16) | a)) +
         chunk("IEND", "");
}

inline std::string base64(const std::string& bytes) {
  static constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t three = 0;
    for (std::size_t c = 0; c < 3; ++c)
      three = three << 8 | (k + c < bytes.size() ? static_cast<unsigned char>(bytes[k + c]) : 0u);
    for (std::size_t c = 0; c < 4; ++c) text += k + c > bytes.size() ? '=' : kLetters[three >> (18 - 6 * c) & 63];
  }
  return text;
}

/// A square of side 2 in y = 0 around the origin, facing up, with texcoords (0, 0) at (-1, 0, 1), u along +x and v
/// along -z. Its node stands at (0, 1, 0) and mirrors x; a camera stands at (0, 3, 5), tilted down by 30 degrees.
struct GltfSquare {
  std::string material = R"({"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.5, 0.25, 1], "metallicFactor": 0.25,
      "roughnessFactor": 0.5}})";
  std::string image;  ///< its URI; empty: the material must not name a texture
  std::string camera = R"({"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1, "aspectRatio": 1.5}})";
  std::string node = R"("translation": [0, 1, 0], "scale": [-1, 1, 1])";

  std::string buffer() const {
    const float places[] = {-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1};
    const float texcoords[] = {0, 0, 0, 1, 1, 1, 1, 0};  // glTF's v goes down
    const std::uint16_t corners[] = {0, 1, 2, 0, 2, 3};
    return std::string(reinterpret_cast<const char*>(places), sizeof places) +
           std::string(reinterpret_cast<const char*>(texcoords), sizeof texcoords) +
           std::string(reinterpret_cast<const char*>(corners), sizeof corners);
  }
  /// `uri`: of the buffer; empty: the binary chunk of a GLB.
  std::string json(const std::string& uri) const {
    const std::string textures =
        image.empty() ? "" : R"("textures": [{"source": 0}], "images": [{"uri": ")" + image + R"("}],)";
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
      "nodes": [{"mesh": 0, )" +
           node + R"(},
                {"camera": 0, "translation": [0, 3, 5], "rotation": [-0.25881905, 0, 0, 0.96592583]}],
      "cameras": [)" +
           camera + R"(],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
      "materials": [)" +
           material + "], " + textures + R"(
      "buffers": [{"byteLength": 92)" +
           (uri.empty() ? "" : ", \"uri\": \"" + uri + "\"") + R"(}],
      "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32},
                      {"buffer": 0, "byteOffset": 80, "byteLength": 12}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, 0, -1],
                     "max": [1, 0, 1]},
                    {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
                    {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}]})";
  }
  std::string gltf() const { return json("data:application/octet-stream;base64," + base64(buffer())); }
  std::string glb() const {
    const auto little_endian = [](std::size_t x) {
      const auto word = static_cast<std::uint32_t>(x);
      return std::string(reinterpret_cast<const char*>(&word), 4);
    };
    std::string text = json(""), binary = buffer();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return "glTF" + little_endian(2) + little_endian(12 + 8 + text.size() + 8 + binary.size()) +
           little_endian(text.size()) + "JSON" + text + little_endian(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

}  // namespace hdr::test
