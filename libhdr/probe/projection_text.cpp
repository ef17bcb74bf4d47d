// hdr:projection as text, e.g. "mirror-ball cx=1000.5 cy=750 r=600 distance=20".
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "libhdr/core/error.h"
#include "libhdr/probe/projection.h"

namespace hdr {
namespace {

using Parameters = std::map<std::string, double>;

// fmt writes the shortest decimal that reads back as the same double.
std::string text_of_disc(const Disc& d) {
  return fmt::format(" cx={} cy={} r={}", d.cx, d.cy, d.r);
}

std::string text_of(const LatLong&) {
  return LatLong::kName;
}
std::string text_of(const AngularMap& map) {
  const bool fills_its_square = map.disc.cx == map.disc.r && map.disc.cy == map.disc.r;
  return AngularMap::kName + (fills_its_square ? std::string() : text_of_disc(map.disc));
}
std::string text_of(const MirrorBall& ball) {
  std::string text = MirrorBall::kName + text_of_disc(ball.disc);
  if (std::isfinite(ball.distance)) text += fmt::format(" distance={}", ball.distance);
  if (ball.principal) text += fmt::format(" px={} py={}", ball.principal->x(), ball.principal->y());
  return text;
}
std::string text_of(const Rectilinear& camera) {
  return fmt::format("{} fov={}", Rectilinear::kName, camera.fov_degrees);
}

/// "key=number" words; nullopt when a word is anything else or a key comes twice.
std::optional<Parameters> parameters_from_words(std::istream& words) {
  Parameters parameters;
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos) return std::nullopt;
    const char* end = word.data() + word.size();
    double value = 0;
    const auto [stop, error] = std::from_chars(word.data() + equals + 1, end, value);
    if (error != std::errc() || stop != end || std::isnan(value)) return std::nullopt;
    if (!parameters.emplace(word.substr(0, equals), value).second) return std::nullopt;
  }
  return parameters;
}

/// Removes a parameter and returns its value, or its default.
double take(Parameters& parameters, const std::string& key, double otherwise) {
  const auto node = parameters.extract(key);
  return node.empty() ? otherwise : node.mapped();
}

/// The parameters cx, cy, r; by default the largest disc in the middle of the picture.
Disc take_disc(Parameters& parameters, Size size) {
  const double cx = take(parameters, "cx", 0.5 * size.width);
  const double cy = take(parameters, "cy", 0.5 * size.height);
  return {cx, cy, take(parameters, "r", 0.5 * std::min(size.width, size.height))};
}

std::optional<Projection> projection_from_parameters(const std::string& name, Parameters& parameters, Size size) {
  if (name == LatLong::kName || name == "lat-long") return LatLong{size};
  if (name == AngularMap::kName) return AngularMap{take_disc(parameters, size)};
  if (name == MirrorBall::kName) {
    MirrorBall ball{take_disc(parameters, size), take(parameters, "distance", std::numeric_limits<double>::infinity())};
    if (parameters.contains("px") && parameters.contains("py"))
      ball.principal = Vec2(take(parameters, "px", 0), take(parameters, "py", 0));
    return ball;
  }
  if (name == Rectilinear::kName) return Rectilinear{size, take(parameters, "fov", 90)};
  return std::nullopt;
}

}  // namespace

std::string text_from_projection(const Projection& projection) {
  return std::visit([](const auto& p) { return text_of(p); }, projection);
}

std::optional<Projection> projection_from_text(const std::string& text, Size size) {
  std::istringstream words(text);
  std::string name;
  words >> name;
  auto parameters = parameters_from_words(words);
  if (!parameters) return std::nullopt;
  auto projection = projection_from_parameters(name, *parameters, size);
  const bool unknown_parameter = !parameters->empty();
  if (!projection || unknown_parameter) return std::nullopt;
  require_valid(*projection);
  return projection;
}

Projection projection_of_probe(const std::string& from, const std::string& tag, Size size, const std::string& source) {
  constexpr const char* kRemedy = "pass --from latlong, angular, mirror-ball or rectilinear";
  const auto tagged = projection_from_text(tag, size);
  if (!from.empty()) {
    const auto named = projection_from_text(from, size);
    if (!named) throw Error(fmt::format("{}: '{}' is not a projection; {}", source, from, kRemedy));
    const bool bare_name = from.find('=') == std::string::npos;
    return bare_name && tagged && tagged->index() == named->index() ? *tagged : *named;
  }
  if (tagged) return *tagged;
  if (!tag.empty()) throw Error(fmt::format("{}: its projection '{}' is unknown; {}", source, tag, kRemedy));
  if (size.width == 2 * size.height && size.width > 0) return LatLong{size};
  throw Error(
      fmt::format("{}: {}x{} is not 2:1 and names no projection; {}", source, size.width, size.height, kRemedy));
}

}  // namespace hdr
