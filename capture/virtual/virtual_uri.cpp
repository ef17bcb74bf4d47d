#include "capture/virtual/virtual_uri.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <functional>
#include <map>

#include "capture/virtual/built_in_scene.h"
#include "libhdr/io/read.h"

namespace hdr {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::size_t start = 0;
  for (std::size_t end = text.find(at); end != std::string::npos; end = text.find(at, start)) {
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  parts.push_back(text.substr(start));
  return parts;
}

/// "NAME:VALUE" or "NAME".
std::pair<std::string, std::string> named(const std::string& text, char at) {
  const std::size_t place = text.find(at);
  if (place == std::string::npos) return {text, ""};
  return {text.substr(0, place), text.substr(place + 1)};
}

const std::map<std::string, PixelFormat> kFormats = {{"grey8", PixelFormat::kGrey8},
                                                     {"grey10", PixelFormat::kGrey10},
                                                     {"grey12", PixelFormat::kGrey12},
                                                     {"grey16", PixelFormat::kGrey16},
                                                     {"rgb8", PixelFormat::kRgb8},
                                                     {"rgb16", PixelFormat::kRgb16},
                                                     {"yuyv", PixelFormat::kYuyv},
                                                     {"mjpeg", PixelFormat::kMjpeg},
                                                     {"bayer8", PixelFormat::kBayer8},
                                                     {"bayer10", PixelFormat::kBayer10},
                                                     {"bayer12", PixelFormat::kBayer12},
                                                     {"bayer16", PixelFormat::kBayer16},
                                                     {"bayer10p", PixelFormat::kBayer10Packed},
                                                     {"bayer12p", PixelFormat::kBayer12Packed}};
const std::map<std::string, Cfa> kCfas = {
    {"rggb", Cfa::kRggb}, {"bggr", Cfa::kBggr}, {"grbg", Cfa::kGrbg}, {"gbrg", Cfa::kGbrg}};

class Parser {
 public:
  explicit Parser(const std::string& uri) : text_(uri) {}

  VirtualUri parse() {
    const auto [place, query] = named(text_.substr(text_.find(':') + 1), '?');
    uri_.scene = place;
    if (query.empty()) return uri_;
    for (const std::string& option : split(query, '&')) {
      const auto [name, value] = named(option, '=');
      apply(name, value);
    }
    if (!(uri_.options.frame_seconds > 0) || !std::isfinite(uri_.options.frame_seconds))
      refuse("fps: give a positive number");
    return uri_;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw CameraError(CameraError::Kind::kNotSupported,
                      fmt::format("{}: {}; the options are listed in capture/virtual/virtual_uri.h", text_, why));
  }

  double number(const std::string& name, const std::string& text) const {
    const auto one = [&](const std::string& digits) {
      double value = 0;
      const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (error != std::errc{} || end != digits.data() + digits.size()) refuse(name + ": '" + text + "' is no number");
      return value;
    };
    const auto [above, below] = named(text, '/');
    const double value = below.empty() ? one(above) : one(above) / one(below);
    if (!std::isfinite(value) || value < 0) refuse(name + ": '" + text + "' is no number of that kind");
    return value;
  }

  int count(const std::string& name, const std::string& text) const {
    const double value = number(name, text);
    if (value > 1e9 || value != std::floor(value)) refuse(name + ": '" + text + "' is no count");
    return static_cast<int>(value);
  }

  Range range(const std::string& name, const std::string& text) const {
    const auto [ends, step] = named(text, ':');
    const std::size_t dots = ends.find("..");
    if (dots == std::string::npos) refuse(name + ": give MIN..MAX or MIN..MAX:STEP");
    const Range range{number(name, ends.substr(0, dots)), number(name, ends.substr(dots + 2)),
                      step.empty() ? 0 : number(name, step)};
    if (!(range.min > 0) || range.max < range.min) refuse(name + ": the range is empty or begins at nothing");
    return range;
  }

  void apply(const std::string& name, const std::string& value) {
    VirtualCameraOptions& o = uri_.options;
    const std::map<std::string, std::function<void()>> options = {
        {"format", [&] { o.formats = formats(value); }},
        {"cfa",
         [&] {
           if (!kCfas.count(value)) refuse("cfa: rggb, bggr, grbg or gbrg");
           o.cfa = kCfas.at(value);
         }},
        {"response",
         [&] {
           if (!response_from_name(value, 8)) refuse("response: srgb, linear, gamma:2.2 or film");
           o.response = value;
         }},
        {"size",
         [&] {
           const auto [width, height] = named(value, 'x');
           uri_.size = {count(name, width), count(name, height)};
           if (uri_.size.width < 16 || uri_.size.height < 16) refuse("size: at least 16x16");
           if (uri_.size.width > 16384 || uri_.size.height > 16384) refuse("size: at most 16384x16384");
         }},
        {"seconds", [&] { o.seconds = range(name, value); }},
        {"gain", [&] { o.gain = range(name, value); }},
        {"fps", [&] { o.frame_seconds = 1 / number(name, value); }},
        {"latency", [&] { o.latency = count(name, value); }},
        {"metadata", [&] { o.metadata = count(name, value) != 0; }},
        {"realtime", [&] { o.realtime = count(name, value) != 0; }},
        {"level", [&] { o.level = number(name, value); }},
        {"full_well", [&] { o.noise.full_well = number(name, value); }},
        {"read_noise", [&] { o.noise.read_noise = number(name, value); }},
        {"seed", [&] { o.seed = static_cast<std::uint64_t>(count(name, value)); }},
        {"flicker",
         [&] {
           const auto [hz, depth] = named(value, ':');
           o.flicker_hz = number(name, hz);
           if (!depth.empty()) o.flicker_depth = number(name, depth);
         }},
        {"faults", [&] { faults(value); }},
    };
    const auto found = options.find(name);
    if (found == options.end()) refuse("there is no option '" + name + "'");
    found->second();
  }

  std::vector<PixelFormat> formats(const std::string& value) const {
    std::vector<PixelFormat> formats;
    for (const std::string& format : split(value, ',')) {
      if (!kFormats.count(format)) refuse("format: there is no '" + format + "'");
      formats.push_back(kFormats.at(format));
    }
    return formats;
  }

  void faults(const std::string& value) {
    VirtualFaults& f = uri_.options.faults;
    for (const std::string& fault : split(value, ',')) {
      const auto [name, amount] = named(fault, ':');
      const std::map<std::string, std::function<void()>> all = {
          {"dropped", [&, a = amount] { f.dropped = number("dropped", a); }},
          {"damaged", [&, a = amount] { f.damaged = number("damaged", a); }},
          {"cut", [&, a = amount] { f.cut = number("cut", a); }},
          {"torn", [&, a = amount] { f.torn = number("torn", a); }},
          {"unplug", [&, a = amount] { f.unplug = count("unplug", a); }},
          {"freeze", [&, a = amount] { f.freeze = count("freeze", a); }},
          {"stall", [&, a = amount] { f.stall = count("stall", a); }},
          {"stuck", [&, a = amount] { f.stuck = count("stuck", a); }},
          {"clamp", [&, a = amount] { f.clamp_seconds = number("clamp", a); }},
          {"busy", [&] { f.busy = true; }},
          {"permission", [&] { f.permission = true; }},
          {"no-manual", [&] { f.no_manual = true; }},
          {"automatic", [&] { f.automatic = true; }},
      };
      const auto found = all.find(name);
      if (found == all.end()) refuse("there is no fault '" + name + "'");
      found->second();
    }
  }

  std::string text_;
  VirtualUri uri_;
};

}  // namespace

VirtualUri parse_virtual_uri(const std::string& uri) {
  return Parser(uri).parse();
}

std::unique_ptr<CameraDevice> open_virtual_camera(const std::string& uri) {
  VirtualUri parsed = parse_virtual_uri(uri);
  Image<float> scene = parsed.scene.empty() ? built_in_scene(parsed.size) : read_map(parsed.scene).map.rgb;
  return std::make_unique<VirtualCamera>(uri, std::move(scene), std::move(parsed.options));
}

std::vector<CameraName> list_virtual_cameras() {
  return {{"virtual:", "virtual camera in a room that is built in"}};
}

}  // namespace hdr
