#include "tools/hdr/options.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "libhdr/core/error.h"
#include "libhdr/probe/vignetting.h"

namespace hdr::tools {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

double number_from_text(const std::string& text, const std::string& option) {
  const char* begin = text.c_str();
  char* end = nullptr;
  const double value = std::strtod(begin, &end);
  if (end == begin || *end != '\0') throw Error(fmt::format("{}: '{}' is not a number", option, text));
  return value;
}

}  // namespace

std::vector<double> times_from_text(const std::string& text, const std::string& option) {
  std::vector<double> times;
  for (const std::string& part : split(text, ',')) {
    const std::size_t slash = part.find('/');
    times.push_back(slash == std::string::npos ? number_from_text(part, option)
                                               : number_from_text(part.substr(0, slash), option) /
                                                     number_from_text(part.substr(slash + 1), option));
  }
  if (times.empty()) throw Error(option + ": no times; give seconds such as 1/250,1/60,2");
  return times;
}

Size size_from_text(const std::string& text, const std::string& option) {
  const std::vector<std::string> parts = split(text, 'x');
  const auto side = [&](const std::string& part) {
    const double value = number_from_text(part, option);
    if (!(value >= 1 && value <= 1 << 17) || value != std::floor(value)) {
      throw Error(fmt::format("{}: '{}' is not a size; give WIDTHxHEIGHT in pixels", option, text));
    }
    return static_cast<int>(value);
  };
  if (parts.size() != 2) throw Error(fmt::format("{}: '{}' is not a size; give WIDTHxHEIGHT in pixels", option, text));
  return {side(parts[0]), side(parts[1])};
}

std::vector<double> numbers_from_text(const std::string& text, const std::string& option, std::size_t count) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.empty() || (count > 0 && parts.size() > count)) {
    const std::string most = count > 0 ? fmt::format("1 to {} ", count) : "";
    throw Error(fmt::format("{}: '{}' is not {}numbers with commas between them", option, text, most));
  }
  std::vector<double> numbers;
  for (const std::string& part : parts) numbers.push_back(number_from_text(part, option));
  if (count > 0) numbers.resize(count, 0);
  return numbers;
}

Vec2 vec2_from_text(const std::string& text, const std::string& option) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 2) throw Error(fmt::format("{}: '{}' is not X,Y", option, text));
  return {number_from_text(parts[0], option), number_from_text(parts[1], option)};
}

Vec3 vec3_from_text(const std::string& text, const std::string& option) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 3) throw Error(fmt::format("{}: '{}' is not X,Y,Z", option, text));
  return {number_from_text(parts[0], option), number_from_text(parts[1], option), number_from_text(parts[2], option)};
}

void ShotsOptions::declare(CLI::App& app) {
  app.add_option("shots", files, "photographs of one scene, or a folder of them, in any order")->required();
  app.add_option("--times", times, "seconds in the order of the files, e.g. 1/1000,1/250,2; replaces EXIF's");
  app.add_option("--exposures", exposures,
                 "a list: lines of `name seconds [f-number [iso [nd_stops]]]`, or in 1/t style");
  app.add_option("--list-format", list_format, "how to read the list")
      ->check(CLI::IsMember({"auto", "seconds", "inverse", "hdrgen"}))
      ->capture_default_str();
}

BracketOptions ShotsOptions::bracket_options() const {
  BracketOptions options;
  if (!times.empty()) options.times = times_from_text(times, "--times");
  if (!exposures.empty()) options.exposures = exposures;
  options.list_format = list_format_from_name(list_format).value();
  options.expects_motion = expects_motion;
  return options;
}

void CalibrateFlags::declare(CLI::App& app) {
  app.add_option("--calibrate-method,--method", method, "how the response is fitted")
      ->check(CLI::IsMember({"debevec-malik", "robertson", "mitsunaga-nayar"}))
      ->capture_default_str();
  app.add_option("--smoothness", smoothness, "weight of the curve's smoothness, or auto: chosen from the data")
      ->capture_default_str();
  app.add_flag("--refine-times", refine_times,
               "fit the exposure times too: shutters are off by a few percent, and 1/60 s on the dial is 1/64");
}

CalibrateOptions CalibrateFlags::options() const {
  CalibrateOptions options;
  options.refine_times = refine_times;
  if (refine_times && method == "robertson") {
    throw CLI::ValidationError("--refine-times", "robertson takes the times as given; use another --method");
  }
  if (smoothness != "auto") {
    options.smoothness = number_from_text(smoothness, "--smoothness");
    if (!(*options.smoothness > 0)) throw Error("--smoothness: give a positive number or auto");
  }
  return options;
}

void MergeFlags::declare(CLI::App& app) {
  app.add_option(
         "--response", response,
         "fit (from these shots), a response file, srgb, linear, gamma:2.2; auto: what the bracket.json of their "
         "folder says, else fit")
      ->capture_default_str();
  app.add_option("--weight", weight, "how shots are weighted; auto looks at the file type")
      ->check(CLI::IsMember({"auto", "hat", "variance"}))
      ->capture_default_str();
  app.add_flag("--uncertainty", uncertainty, "also write each pixel's standard deviation, as layer stddev (EXR)");
  app.add_flag("--deghost", deghost, "where things moved between the shots, the map shows one moment");
  app.add_option("--ghost-mask", ghost_mask, "with --deghost: a picture (.png, .exr) of where shots were left out");
  app.add_flag("--drift", drift,
               "the light changed from shot to shot (lamps, clouds, uneven shutters): a gain for each, reported");
  app.add_option("--black-level", black_level, "the code that means no light (default: the response's own)")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--flat", flat, "a uniform scene as this camera saw it, a radiance map or a photograph; divided out");
}

MergeOptions MergeFlags::options() const {
  MergeOptions options;
  if (weight == "hat") options.weight = WeightKind::kHat;
  if (weight == "variance") options.weight = WeightKind::kVariance;
  options.uncertainty = uncertainty;
  options.deghost = deghost;
  options.drift = drift;
  if (!ghost_mask.empty() && !deghost) {
    throw CLI::ValidationError("--ghost-mask", "shows what --deghost did; add --deghost");
  }
  options.black_level = black_level;
  return options;
}

void ScaleFlags::declare(CLI::App& app) {
  app.add_option("--cd-per-unit", cd_per_unit, "cd/m^2 of radiance 1, written as whiteLuminance (default: from EXIF)")
      ->check(CLI::PositiveNumber);
  app.add_option("--patch", patch,
                 "CX,CY,R=CD: the disc of the merged map (pixels, y down) has a mean luminance of CD cd/m^2; or "
                 "CX,CY,R=18%: it is matte, has that reflectance, and --lux says what falls on it");
  app.add_option("--lux", lux,
                 "what a lux meter read: on a horizontal surface facing up, under the finished probe (hdr probe); or, "
                 "with --patch CX,CY,R=18%, on that patch (a grey card)")
      ->check(CLI::PositiveNumber);
  app.add_option("--scale-like", scale_like,
                 "an EXR that hdr merged: the new map has its unit, so that the two compare directly, and its "
                 "whiteLuminance unless another option gives one");
}

void ScaleFlags::check() const {
  const bool has_patch = !patch.empty();
  if (cd_per_unit && (has_patch || lux)) {
    throw CLI::ValidationError("--cd-per-unit", "says what --patch and --lux measure; give one of them");
  }
  const bool grey_card = has_patch && patch_from_text(patch).reflectance;
  if (grey_card && !lux) throw CLI::ValidationError("--patch", "a reflectance needs --lux, the light that falls on it");
  if (has_patch && !grey_card && lux) {
    throw CLI::ValidationError("--lux", "the patch's luminance is given already; give its reflectance (=18%) instead");
  }
  if (lux && !has_patch && !makes_probe) {
    throw CLI::ValidationError("--lux",
                               "a plain map shows no sphere to integrate; add --patch CX,CY,R=18% (a grey "
                               "card), or use hdr probe");
  }
}

Patch patch_from_text(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) throw Error(fmt::format("--patch: '{}' is not CX,CY,R=CD or CX,CY,R=18%", text));
  const Vec3 disc = vec3_from_text(text.substr(0, equals), "--patch");
  Patch patch{disc.x(), disc.y(), disc.z(), {}, {}};
  std::string value = text.substr(equals + 1);
  const bool percent = value.ends_with('%');
  if (percent) value.pop_back();
  const double number = number_from_text(value, "--patch");
  if (!(patch.r > 0)) throw Error("--patch: the radius must be positive; give CX,CY,R in pixels");
  if (!(number > 0 && std::isfinite(number))) throw Error("--patch: give a positive luminance or reflectance");
  if (percent && number > 100) throw Error("--patch: a matte patch reflects 100 % at most");
  (percent ? patch.reflectance : patch.luminance) = percent ? number / 100 : number;
  return patch;
}

AlignMethod align_method(const std::string& name) {
  const auto method = align_method_from_name(name);
  if (!method) throw CLI::ValidationError("--align", "'" + name + "' is not one of auto, none, mtb, ecc, features");
  return *method;
}

void WriteFlags::declare(CLI::App& app) {
  app.add_option("--type", type, "EXR samples")->check(CLI::IsMember({"half", "float"}))->capture_default_str();
  app.add_option("--compression", compression,
                 "of EXR; of TIFF: none, lzw, zip, or pixarlog, logluv, logluv24, logl, which lose a little")
      ->check(CLI::IsMember({"none", "rle", "zip", "zips", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab", "lzw",
                             "pixarlog", "logluv", "logluv24", "logl"}))
      ->capture_default_str();
}

WriteOptions WriteFlags::options() const {
  return {type == "float" ? SampleType::kFloat : SampleType::kHalf, compression, false};
}

void UnwrapFlags::declare(CLI::App& app) {
  app.add_option(
      "--from", from,
      std::string(
          "what the picture is (default: its hdr:projection; mirror-ball with --ball, --distance, --camera-fov or "
          "--reflectance, fisheye with --circle): ") +
          kProjectionNames);
  app.add_option("--to", to, "what to write: the same, and cube-cross-vertical")->capture_default_str();
  app.add_option("--width", width, "width to write, pixels")->check(CLI::Range(1, 65536))->capture_default_str();
  const auto implies_ball = [this](const std::string&) { implied_from = MirrorBall::kName; };
  app.add_option("--ball", ball, "the ball's outline CX,CY,R in pixels, or auto: found")
      ->capture_default_str()
      ->each(implies_ball);
  app.add_option("--distance", distance,
                 "camera to the ball's centre, in ball radii (default: by the focal length in EXIF, of a photograph or "
                 "of those that were merged, else far)")
      ->each(implies_ball);
  app.add_option(
         "--camera-fov", camera_fov,
         "horizontal field of the whole photograph that shows the ball, degrees: gives the distance, and the true "
         "rays of a ball beside the middle")
      ->each(implies_ball);
  app.add_option("--reflectance", reflectance,
                 "R,G,B: the share of light the ball gives back head-on, e.g. 0.55,0.56,0.55 for chrome; divided out")
      ->each(implies_ball);
  app.add_option("--circle", circle,
                 "a fisheye's image circle CX,CY,R in pixels, or auto: its hdr:projection's, else found")
      ->capture_default_str()
      ->each([this](const std::string&) { implied_from = Fisheye::kName; });
  app.add_option("--fov", fov,
                 "field in degrees of a rectilinear picture or a panorama (horizontal) or across a fisheye's circle "
                 "(default: its hdr:projection's, or 90, 360 and 180)");
  app.add_option("--vfov", vfov, "of a panorama: its vertical field, degrees (default: square pixels)");
  app.add_option("--centre", centre,
                 "AZ,EL of a panorama's middle: degrees to the right of +Z and above the horizon (default: 0,0)");
  app.add_option("--crop", crop,
                 "X,Y,W,H: this rectangle of a lat-long or a panorama is what is read; where it was is remembered");
  app.add_flag("--level", level, "what is vertical in the picture (walls, trunks) becomes vertical, before --rotate");
  app.add_option("--horizon", horizon, "X,Y,X,Y,...: pixels on the true horizon, which becomes level, before --rotate");
  app.add_option("--lens", lens, "of a fisheye (default: its hdr:projection's, or equidistant)")
      ->check(
          CLI::IsMember({"equidistant", "equisolid", "stereographic", "orthographic", "polynomial", "kannala-brandt"}));
  app.add_option("--lens-k", lens_k, "K1,K2,K3,K4 of a polynomial or kannala-brandt lens");
  app.add_option("--distortion", distortion, "K1,K2,P1,P2,K3 of a rectilinear lens (Brown-Conrady, as OpenCV's)");
  app.add_option(
      "--vignetting", vignetting,
      "K1,K2,K3: the picture's lens passes 1 + K1 r^2 + K2 r^4 + K3 r^6, r in half-diagonals (lensfun's pa); "
      "divided out");
  app.add_option("--rotate", rotate, "X,Y,Z degrees: d_out = Rz Ry Rx d_in")->capture_default_str();
  const auto conventions = CLI::IsMember(
      {"openexr", "usd", "mitsuba", "blender", "threejs", "gltf", "pbrt", "alicevision", "hdrtoolbox", "opengl"});
  app.add_option("--convention", convention, "which way round a program expects the lat-long or the cube to be written")
      ->check(conventions)
      ->capture_default_str();
  app.add_option("--from-convention", from_convention, "likewise, of the lat-long or the cube that is read")
      ->check(conventions);
}

std::string UnwrapFlags::from_of(const std::string& tag, const std::string& otherwise) const {
  if (!from.empty() || !tag.empty()) return from;
  return implied_from.empty() ? otherwise : implied_from;
}

void UnwrapFlags::declare_seam(CLI::App& app) {
  app.add_option("--seam", seam,
                 "between two fisheyes: feather, along the ring where they differ least; cut: a graph cut, which goes "
                 "around what moved")
      ->check(CLI::IsMember({"feather", "cut"}))
      ->capture_default_str();
}

std::string UnwrapFlags::with_field(const std::string& name) const {
  if (name != Panorama::kName) return name;
  std::string text = name;
  if (fov) text += fmt::format(" fov={}", *fov);
  if (vfov) text += fmt::format(" vfov={}", *vfov);
  if (centre.empty()) return text;
  const Vec2 middle = vec2_from_text(centre, "--centre");
  return text + fmt::format(" azimuth={} elevation={}", middle.x(), middle.y());
}

namespace {

/// --lens, --lens-k and --fov on a fisheye, --distortion and --fov on a rectilinear picture.
void apply_lens(const UnwrapFlags& flags, Projection& projection, bool with_fov) {
  if (auto* view = std::get_if<Rectilinear>(&projection)) {
    if (flags.fov && with_fov) view->fov_degrees = *flags.fov;
    if (!flags.distortion.empty()) {
      const std::vector<double> d = numbers_from_text(flags.distortion, "--distortion", 5);
      view->distortion = {d[0], d[1], d[2], d[3], d[4]};
    }
  }
  if (auto* fisheye = std::get_if<Fisheye>(&projection)) {
    if (flags.fov && with_fov) fisheye->fov_degrees = *flags.fov;
    if (!flags.lens.empty()) fisheye->lens = lens_from_name(flags.lens).value();
    if (!flags.lens_k.empty()) {
      const std::vector<double> k = numbers_from_text(flags.lens_k, "--lens-k", 4);
      std::copy(k.begin(), k.end(), fisheye->k.begin());
    }
  }
}

void apply_convention(Convention convention, Projection& projection) {
  if (auto* map = std::get_if<LatLong>(&projection)) map->convention = convention;
  if (auto* cube = std::get_if<Cube>(&projection)) cube->convention = convention;
  if (auto* map = std::get_if<Octahedral>(&projection)) map->equal_area |= convention == Convention::kPbrt;
}

}  // namespace

void UnwrapFlags::correct_vignetting(RadianceMap& map) const {
  if (vignetting.empty()) return;
  const std::vector<double> k = numbers_from_text(vignetting, "--vignetting", 3);
  divide_vignetting(map, {k[0], k[1], k[2]});
}

bool UnwrapFlags::target_has_field() const {
  return to.starts_with(Fisheye::kName) || to.starts_with(Rectilinear::kName) || to == Panorama::kName;
}

void UnwrapFlags::apply_to_source(Projection& source, bool with_fov) const {
  apply_lens(*this, source, with_fov);
  if (auto* fisheye = std::get_if<Fisheye>(&source); fisheye && circle != "auto") {
    const Vec3 numbers = vec3_from_text(circle, "--circle");
    fisheye->disc = {numbers.x(), numbers.y(), numbers.z()};
  }
  if (!from_convention.empty()) apply_convention(convention_from_name(from_convention).value(), source);
  require_valid(source);
}

NewPicture UnwrapFlags::target() const {
  auto picture = picture_of_width(with_field(to), width);
  if (!picture) throw CLI::ValidationError("--to", fmt::format("'{}' is not one of {}", to, kProjectionNames));
  if (auto* ball_out = std::get_if<MirrorBall>(&picture->projection); ball_out && distance) {
    ball_out->distance = *distance;
  }
  apply_lens(*this, picture->projection, to.find("fov=") == std::string::npos);
  apply_convention(convention_from_name(convention).value(), picture->projection);
  require_valid(picture->projection);
  return *picture;
}

}  // namespace hdr::tools
