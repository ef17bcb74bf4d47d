// hdr:projection as text, e.g. "mirror-ball cx=1000.5 cy=750 r=600 distance=20".
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/probe/projection.h"

namespace hdr {

const char* const kProjectionNames =
    "lat-long, angular, mirror-ball, fisheye, rectilinear, cube-cross, cube-strip, cube-faces, octahedral, hemisphere, "
    "dual-paraboloid, panorama";

namespace {

// fmt writes the shortest decimal that reads back as the same double.
std::string text_of(const char* key, double value, double otherwise = 0) {
  return value == otherwise ? std::string() : fmt::format(" {}={}", key, value);
}
std::string text_of(const Disc& d) {
  return fmt::format(" cx={} cy={} r={}", d.cx, d.cy, d.r);
}
std::string text_of(Convention convention) {
  return convention == Convention::kOpenExr ? std::string() : fmt::format(" convention={}", name_of(convention));
}

std::string text_of(const LatLong& map) {
  return LatLong::kName + text_of(map.convention);
}
std::string text_of(const Panorama& map) {
  return fmt::format("{} fov={} vfov={}", Panorama::kName, map.fov_degrees, map.vfov_degrees) +
         text_of("azimuth", map.azimuth_degrees) + text_of("elevation", map.elevation_degrees);
}
std::string text_of(const AngularMap& map) {
  const bool fills_its_square = map.disc.cx == map.disc.r && map.disc.cy == map.disc.r;
  return AngularMap::kName + (fills_its_square ? std::string() : text_of(map.disc));
}
std::string text_of(const MirrorBall& ball) {
  std::string text = MirrorBall::kName + text_of(ball.disc);
  if (std::isfinite(ball.distance)) text += fmt::format(" distance={}", ball.distance);
  if (ball.principal) text += fmt::format(" px={} py={}", ball.principal->x(), ball.principal->y());
  return text;
}
std::string text_of(const Rectilinear& camera) {
  const BrownConrady& d = camera.distortion;
  return fmt::format("{} fov={}", Rectilinear::kName, camera.fov_degrees) + text_of("k1", d.k1) + text_of("k2", d.k2) +
         text_of("p1", d.p1) + text_of("p2", d.p2) + text_of("k3", d.k3);
}
std::string text_of(const Fisheye& fisheye) {
  std::string text = Fisheye::kName + text_of(fisheye.disc) + fmt::format(" fov={}", fisheye.fov_degrees) +
                     fmt::format(" lens={}", name_of(fisheye.lens));
  for (std::size_t i = 0; i < 4; ++i) text += text_of(fmt::format("k{}", i + 1).c_str(), fisheye.k[i]);
  return text;
}
std::string text_of(const Cube& cube) {
  const bool cross = cube.layout == Cube::Layout::kHorizontalCross || cube.layout == Cube::Layout::kVerticalCross;
  const char* name = cube.layout == Cube::Layout::kFaces ? "cube-faces" : cross ? "cube-cross" : "cube-strip";
  return name + text_of(cube.convention);
}
std::string text_of(const Octahedral& map) {
  return Octahedral::kName + text_of("equal-area", map.equal_area ? 1 : 0);
}
std::string text_of(const Hemisphere& map) {
  return Hemisphere::kName + text_of(map.disc);
}
std::string text_of(const DualParaboloid&) {
  return DualParaboloid::kName;
}

/// The words "key=value" of a text. What is asked for is taken out; what then is left, or cannot be read, is unknown.
class Parameters {
 public:
  explicit Parameters(std::istream& words) {
    for (std::string word; words >> word;) {
      const std::size_t equals = word.find('=');
      if (equals == std::string::npos || !values_.emplace(word.substr(0, equals), word.substr(equals + 1)).second) {
        bad_ = true;
      }
    }
  }
  bool all_understood() const { return !bad_ && values_.empty(); }

  bool contains(const std::string& key) const { return values_.contains(key); }

  double number(const std::string& key, double otherwise) {
    const auto node = values_.extract(key);
    if (node.empty()) return otherwise;
    const std::string& text = node.mapped();
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || stop != text.data() + text.size() || std::isnan(value)) bad_ = true;
    return value;
  }
  template <class T>
  T word(const std::string& key, T otherwise, std::optional<T> (*from_name)(const std::string&)) {
    const auto node = values_.extract(key);
    if (node.empty()) return otherwise;
    const std::optional<T> value = from_name(node.mapped());
    if (!value) bad_ = true;
    return value.value_or(otherwise);
  }
  /// cx, cy, r; by default the largest disc in the middle of the picture.
  Disc disc(Size size) {
    const double cx = number("cx", 0.5 * size.width), cy = number("cy", 0.5 * size.height);
    return {cx, cy, number("r", 0.5 * std::min(size.width, size.height))};
  }
  Convention convention() { return word("convention", Convention::kOpenExr, convention_from_name); }

 private:
  std::map<std::string, std::string> values_;
  bool bad_ = false;
};

/// The layout that has this shape: width : height of a cube's picture are small numbers of faces.
Cube cube_of_shape(const std::string& name, Size size, Convention convention) {
  using Layout = Cube::Layout;
  const std::vector<Layout> layouts =
      name == "cube-faces"            ? std::vector{Layout::kFaces}
      : name == "cube-cross"          ? std::vector{Layout::kHorizontalCross, Layout::kVerticalCross}
      : name == "cube-cross-vertical" ? std::vector{Layout::kVerticalCross}
                                      : std::vector{Layout::kVerticalStrip, Layout::kHorizontalStrip};
  std::string shapes;
  for (const Layout layout : layouts) {
    const Size unit = Cube{layout, 1}.size();
    const Cube cube{layout, size.width / unit.width, convention};
    if (cube.face_px > 0 && cube.size() == size) return cube;
    shapes += shapes.empty() ? "" : " or ";
    shapes += fmt::format("{}:{}", unit.width, unit.height);
  }
  throw Error(fmt::format("{}: its square faces make a picture of {}, and {}x{} is not; crop it", name, shapes,
                          size.width, size.height));
}

bool is_cube_name(const std::string& name) {
  return name == "cube-cross" || name == "cube-cross-vertical" || name == "cube-strip" || name == "cube-faces";
}

Fisheye fisheye_from(Parameters& parameters, Size size) {
  Fisheye fisheye;
  fisheye.disc = parameters.disc(size);
  fisheye.fov_degrees = parameters.number("fov", 180);
  fisheye.lens = parameters.word("lens", Lens::kEquidistant, lens_from_name);
  for (std::size_t i = 0; i < 4; ++i) fisheye.k[i] = parameters.number(fmt::format("k{}", i + 1), 0);
  return fisheye;
}

Rectilinear rectilinear_from(Parameters& parameters, Size size) {
  Rectilinear camera{size, parameters.number("fov", 90), {}};
  BrownConrady& d = camera.distortion;
  for (auto [key, value] : {std::pair{"k1", &d.k1}, {"k2", &d.k2}, {"p1", &d.p1}, {"p2", &d.p2}, {"k3", &d.k3}}) {
    *value = parameters.number(key, 0);
  }
  return camera;
}

Projection panorama_from(Parameters& parameters, Size size) {
  Panorama map{size, parameters.number("fov", 360)};
  map.vfov_degrees = parameters.number("vfov", map.fov_degrees * size.height / std::max(1, size.width));
  map.azimuth_degrees = parameters.number("azimuth", 0);
  map.elevation_degrees = parameters.number("elevation", 0);
  const bool whole = map.fov_degrees == 360 && map.vfov_degrees == 180;
  if (whole && map.azimuth_degrees == 0 && map.elevation_degrees == 0) return LatLong{size};
  return map;
}

std::optional<Projection> projection_from(const std::string& name, Parameters& parameters, Size size) {
  if (name == LatLong::kName || name == "lat-long") return LatLong{size, parameters.convention()};
  if (name == Panorama::kName) return panorama_from(parameters, size);
  if (name == AngularMap::kName) return AngularMap{parameters.disc(size)};
  if (name == MirrorBall::kName) {
    const Disc disc = parameters.disc(size);
    MirrorBall ball{disc, parameters.number("distance", std::numeric_limits<double>::infinity())};
    if (parameters.contains("px") && parameters.contains("py")) {
      const double x = parameters.number("px", 0);
      ball.principal = Vec2(x, parameters.number("py", 0));
    }
    return ball;
  }
  if (name == Rectilinear::kName) return rectilinear_from(parameters, size);
  if (name == Fisheye::kName) return fisheye_from(parameters, size);
  if (is_cube_name(name)) return cube_of_shape(name, size, parameters.convention());
  if (name == Octahedral::kName) return Octahedral{size, parameters.number("equal-area", 0) != 0};
  if (name == Hemisphere::kName) return Hemisphere{parameters.disc(size)};
  if (name == DualParaboloid::kName) return DualParaboloid{size};
  return std::nullopt;
}

std::string first_word(const std::string& text) {
  std::string word;
  std::istringstream(text) >> word;
  return word;
}

/// The size of a picture of this width; faces must come out whole.
Size size_of_width(const std::string& name, int width) {
  const int across = name == "cube-cross" ? 4 : name == "cube-cross-vertical" ? 3 : 1;
  if (width % across != 0) {
    throw Error(fmt::format("{}: {} pixels are not {} whole faces; give a width of {} or {}", name, width, across,
                            std::max(1, width / across) * across, (width / across + 1) * across));
  }
  const int face = width / across;
  if (name == "cube-cross") return {width, 3 * face};
  if (name == "cube-cross-vertical") return {width, 4 * face};
  if (is_cube_name(name)) return {width, 6 * face};
  const bool wide =
      name == LatLong::kName || name == "lat-long" || name == DualParaboloid::kName || name == Panorama::kName;
  return {width, wide ? std::max(1, width / 2) : width};
}

}  // namespace

std::string text_from_projection(const Projection& projection) {
  return std::visit([](const auto& p) { return text_of(p); }, projection);
}

std::optional<Projection> projection_from_text(const std::string& text, Size size) {
  std::istringstream words(text);
  std::string name;
  words >> name;
  Parameters parameters(words);
  auto projection = projection_from(name, parameters, size);
  if (!projection || !parameters.all_understood()) return std::nullopt;
  require_valid(*projection);
  return projection;
}

std::optional<NewPicture> picture_of_width(const std::string& text, int width) {
  Size size = size_of_width(first_word(text), width);
  if (first_word(text) == Panorama::kName) {
    // Square pixels at the horizon: as high as its field says, which by default is half as high as wide.
    const auto part = projection_from_text(text, {width, std::max(1, width / 2)});
    const auto* map = part ? std::get_if<Panorama>(&*part) : nullptr;
    if (!map) return part ? std::optional(NewPicture{*part, size}) : std::nullopt;
    Panorama panorama = *map;
    panorama.size =
        size = {width, std::max(1, static_cast<int>(std::lround(width * map->vfov_degrees / map->fov_degrees)))};
    return NewPicture{panorama, size};
  }
  auto projection = projection_from_text(text, size);
  if (!projection) return std::nullopt;
  return NewPicture{*projection, size};
}

Projection projection_of_probe(const std::string& from, const std::string& tag, Size size, const std::string& source) {
  const std::string remedy = fmt::format("pass --from with one of {}", kProjectionNames);
  const auto checked = [&](const std::string& text) {
    try {
      return projection_from_text(text, size);
    } catch (const Error& error) {
      throw Error(source + ": " + error.what());
    }
  };
  // A name that the tag does not bear overrules the tag, which then may say what it likes.
  std::optional<Projection> tagged;
  if (from.empty() || first_word(from) == first_word(tag)) tagged = checked(tag);
  if (!from.empty()) {
    const auto named = checked(from);
    if (!named) throw Error(fmt::format("{}: '{}' is not a projection; {}", source, from, remedy));
    const bool bare_name = from.find('=') == std::string::npos;
    return bare_name && tagged && tagged->index() == named->index() ? *tagged : *named;
  }
  if (tagged) return *tagged;
  if (!tag.empty()) throw Error(fmt::format("{}: its projection '{}' is unknown; {}", source, tag, remedy));
  if (size.width == 2 * size.height && size.width > 0) return LatLong{size};
  throw Error(fmt::format("{}: {}x{} is not 2:1 and names no projection; {}", source, size.width, size.height, remedy));
}

}  // namespace hdr
