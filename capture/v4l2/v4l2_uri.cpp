#include "capture/v4l2/v4l2_uri.h"

#include <charconv>
#include <string_view>

#include "capture/camera.h"
#include "capture/v4l2/formats.h"

namespace hdr::v4l2 {
namespace {

/// The whole text as a number.
template <typename T>
std::optional<T> number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool apply(std::string_view name, std::string_view value, Uri& uri) {
  if (name == "format") {
    std::string code(value);
    code.resize(4, ' ');  // codes are padded: "Y16 "
    std::uint32_t fourcc = 0;
    for (int k = 3; k >= 0; --k) fourcc = fourcc << 8 | static_cast<std::uint8_t>(code[static_cast<std::size_t>(k)]);
    uri.fourcc = fourcc;
    return find_format(fourcc) != nullptr && value.size() <= 4;
  }
  if (name == "size") {
    const std::size_t times = value.find('x');
    if (times == std::string_view::npos) return false;
    const auto width = number<int>(value.substr(0, times)), height = number<int>(value.substr(times + 1));
    if (!width || !height || *width <= 0 || *height <= 0) return false;
    uri.size = Size{*width, *height};
    return true;
  }
  const auto black = number<double>(value);
  uri.black_level = black.value_or(0);
  return name == "black" && black && *black >= 0;
}

}  // namespace

Uri parse_uri(const std::string& uri) {
  Uri result;
  const std::string_view whole(uri);
  const std::size_t question = whole.find('?'), start = whole.find(':') + 1;
  result.path = whole.substr(start, question == std::string_view::npos ? question : question - start);
  std::string_view rest = question == std::string_view::npos ? "" : whole.substr(question + 1);
  while (!rest.empty()) {
    const std::string_view option = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), option.size() + 1));
    const std::size_t equals = option.find('=');
    const bool good =
        equals != std::string_view::npos && apply(option.substr(0, equals), option.substr(equals + 1), result);
    if (!good) {
      throw CameraError(CameraError::Kind::kNotSupported,
                        uri + ": no such option: " + std::string(option) +
                            "; there are format=YUYV, size=640x480 and black=64, joined by &");
    }
  }
  return result;
}

}  // namespace hdr::v4l2
