#include "tools/hdr/report/embed.h"

#include <Imath/half.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <limits>
#include <regex>

#include "tests/support/support.h"

namespace hdr::report {
namespace {

std::string bytes_from_base64(const std::string& text) {
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) out += static_cast<char>((bits >> (count -= 8)) & 0xFF);
  }
  return out;
}

std::string inflated(const std::string& bytes, std::size_t size) {
  std::string out(size, '\0');
  uLongf written = size;
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(out.data()), &written, reinterpret_cast<const Bytef*>(bytes.data()),
                       bytes.size()),
            Z_OK);
  EXPECT_EQ(written, size);
  return out;
}

struct Element {
  int width = 0, height = 0, channels = 0;
  double scale = 1;
  std::string data;
};

Element element_of(const std::string& html) {
  const auto attribute = [&](const char* name) {
    std::smatch found;
    const std::regex pattern(std::string("data-") + name + "=\"([^\"]*)\"");
    return std::regex_search(html, found, pattern) ? std::stod(found[1]) : std::nan("");
  };
  const std::size_t first = html.find('>') + 1;
  return {static_cast<int>(attribute("width")), static_cast<int>(attribute("height")),
          static_cast<int>(attribute("channels")), attribute("scale"),
          bytes_from_base64(html.substr(first, html.rfind("</script>") - first))};
}

/// As web/picture.js reads it.
Image<float> picture_of(const Element& e) {
  Image<float> out(e.width, e.height, e.channels);
  const std::size_t plane = static_cast<std::size_t>(e.width * e.channels);
  const std::string bytes = inflated(e.data, 2 * plane * static_cast<std::size_t>(e.height));
  for (int y = 0; y < e.height; ++y) {
    for (int c = 0; c < e.channels; ++c) {
      unsigned high = 0, low = 0;
      for (int x = 0; x < e.width; ++x) {
        const std::size_t at = 2 * plane * static_cast<std::size_t>(y) + static_cast<std::size_t>(c * e.width + x);
        high = (high + static_cast<unsigned char>(bytes[at])) & 0xFF;
        low = (low + static_cast<unsigned char>(bytes[at + plane])) & 0xFF;
        Imath::half h;
        h.setBits(static_cast<std::uint16_t>(high << 8 | low));
        out(x, y, c) = static_cast<float>(h * e.scale);
      }
    }
  }
  return out;
}

TEST(Base64, IsThatOfRfc4648) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : vectors) EXPECT_EQ(base64(bytes), text);
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(Embedded, RadianceComesBackWithinAStepOfTheScreen) {
  for (const double gain : {1.0, 1e5}) {
    Image<float> scene = test::test_scene(37, 11, 16, 5);
    for (int y = 0; y < 11; ++y) {
      for (int k = 0; k < 37 * 3; ++k) scene.row(y)[k] *= static_cast<float>(gain);
    }
    const Image<float> back = picture_of(element_of(embedded_radiance("map", scene)));
    ASSERT_EQ(back.size(), scene.size());
    double worst = 0;
    for (int y = 0; y < 11; ++y) {
      for (int k = 0; k < 37 * 3; ++k) {
        if (scene.row(y)[k] > 1e-3f) {
          worst = std::max(worst, std::abs(std::log(static_cast<double>(back.row(y)[k]) / scene.row(y)[k])));
        }
      }
    }
    EXPECT_LE(worst, 1.0 / 256 + 1.0 / 2048 + 1e-5) << "a step of an sRGB code is .9 % at white";
    EXPECT_GT(worst, 0);
  }
}

TEST(Embedded, WhatIsNoLightIsBlack) {
  Image<float> odd(4, 1, 3);
  const float inf = std::numeric_limits<float>::infinity();
  const float values[] = {std::nanf(""), -1, inf, -inf, 1, 1e9f, 0, 1e-20f, 2, 65504, 65503, 0.5f};
  std::copy(std::begin(values), std::end(values), odd.row(0));
  const Image<float> back = picture_of(element_of(embedded_radiance("a\"b", odd)));
  const double expected[] = {0, 0, 0, 0, 1, 1e9, 0, 0, 2, 65504, 65503, 0.5};
  for (int k = 0; k < 12; ++k) EXPECT_NEAR(back.row(0)[k], expected[k], expected[k] / 200) << k;
}

TEST(Embedded, BytesComeBack) {
  Image<std::uint8_t> mask(5, 3, 1);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) mask(x, y) = static_cast<std::uint8_t>(50 * x + y);
  }
  const Element e = element_of(embedded_bytes("mask", mask));
  const std::string bytes = inflated(e.data, 15);
  for (int k = 0; k < 15; ++k)
    EXPECT_EQ(static_cast<unsigned char>(bytes[static_cast<std::size_t>(k)]), 50 * (k % 5) + k / 5);
}

}  // namespace
}  // namespace hdr::report
