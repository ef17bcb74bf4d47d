#include "tools/hdr/unwrap_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/io/read.h"
#include "libhdr/probe/ball_doubt.h"
#include "libhdr/probe/find_ball.h"
#include "libhdr/probe/find_image_circle.h"
#include "libhdr/probe/find_level.h"
#include "libhdr/probe/reflectance.h"
#include "libhdr/probe/unwrap.h"
#include "tools/hdr/camera_field.h"

namespace hdr::tools {
namespace {

/// What --ball says, or the search: with its distance where the picture, or the camera's field, tells.
BallGeometry ball_outline(Run& run, const RadianceMap& picture, const UnwrapFlags& flags,
                          const std::optional<double>& camera_fov, const std::string& source) {
  if (flags.ball != "auto") {
    const Vec3 numbers = vec3_from_text(flags.ball, "--ball");
    if (!(numbers.z() > 0)) throw Error("--ball: the radius must be positive; give CX,CY,R in pixels");
    const Disc disc{numbers.x(), numbers.y(), numbers.z()};
    const Size size = picture.size();
    if (disc.cx + disc.r <= 0 || disc.cy + disc.r <= 0 || disc.cx - disc.r >= size.width ||
        disc.cy - disc.r >= size.height) {
      throw Error(fmt::format("--ball: {} lies outside of the {}x{} picture", flags.ball, size.width, size.height));
    }
    if (camera_fov) return {ball_in_photograph(disc, size, *camera_fov), true};
    return {{disc}, true};
  }
  const auto found = run.stage("find ball", [&] { return find_ball(picture.rgb, {camera_fov}); });
  if (!found)
    throw Error(
        source +
        ": no mirror ball found: most of its outline must be in the picture; pass --ball CX,CY,R (pixels, y down)");
  run.answer["ball_support"] = found->support;
  run.answer["ball_residual_px"] = found->residual_px;
  return {found->ball};
}

/// The outline, the distance, and what is not sure of them.
void say_ball(Run& run, const BallGeometry& geometry) {
  const MirrorBall& ball = geometry.ball;
  std::string text =
      fmt::format("ball: centre {:.2f}, {:.2f}, radius {:.2f} px", ball.disc.cx, ball.disc.cy, ball.disc.r);
  if (std::isfinite(ball.distance)) text += fmt::format(", camera at {:.2f} radii", ball.distance);
  if (geometry.direction_doubt_degrees > 0) {
    run.answer["ball"]["direction_doubt_degrees"] = geometry.direction_doubt_degrees;
    text += fmt::format(
        ", camera taken for far: were it at 5 radii, directions would be up to {:.1f} degrees off "
        "(--distance, --camera-fov)",
        geometry.direction_doubt_degrees);
  }
  run.say(text);
}

/// Half a ball is no sphere; a ball that touches the frame is one with a hole.
void require_mostly_in_frame(Run& run, const MirrorBall& ball, Size size, const std::string& source) {
  constexpr double kLeast = 0.6, kWhole = 0.99;
  constexpr int kRows = 400;
  double inside = 0, all = 0;
  for (int k = 0; k < kRows; ++k) {
    const double y = (2 * (k + 0.5) / kRows - 1) * ball.disc.r, half = std::sqrt(ball.disc.r * ball.disc.r - y * y);
    const double left = std::max(0.0, ball.disc.cx - half);
    const double right = std::min(static_cast<double>(size.width), ball.disc.cx + half);
    all += 2 * half;
    if (ball.disc.cy + y >= 0 && ball.disc.cy + y <= size.height) inside += std::max(0.0, right - left);
  }
  const std::string share = fmt::format("{}: the picture shows {:.0f} % of the ball", source, 100 * inside / all);
  if (inside < kLeast * all)
    throw Error(fmt::format("{} ({:.0f}, {:.0f}, radius {:.0f} px); photograph all of it, or correct --ball CX,CY,R",
                            share, ball.disc.cx, ball.disc.cy, ball.disc.r));
  if (inside < kWhole * all) run.warn(share + "; the rest of the sphere stays black");
}

Disc image_circle(Run& run, const RadianceMap& picture, const std::string& source) {
  const auto found = run.stage("find circle", [&] { return find_image_circle(picture.rgb); });
  if (!found) throw Error(source + ": no image circle found; pass --circle CX,CY,R (pixels, y down)");
  run.say(
      fmt::format("circle: centre {:.2f}, {:.2f}, radius {:.2f} px", found->disc.cx, found->disc.cy, found->disc.r));
  return found->disc;
}

RadianceMap copy_of(const RadianceMap& map) {
  RadianceMap copy;
  copy.rgb = map.rgb.clone();
  copy.alpha = map.alpha.clone();
  copy.stddev = map.stddev.clone();
  copy.chromaticities = map.chromaticities;
  copy.white_luminance = map.white_luminance;
  copy.projection = map.projection;
  return copy;
}

/// What --crop leaves. A lat-long or panorama whose geometry is known becomes a panorama that is so too.
RadianceMap cropped(const RadianceMap& picture, const UnwrapFlags& flags, const std::string& from_text,
                    const std::string& source) {
  const std::vector<double> numbers = numbers_from_text(flags.crop, "--crop", 4);
  const auto whole = [&](double value) {
    if (value != std::floor(value) || std::abs(value) > 1e6) throw Error("--crop: give whole pixels, X,Y,W,H");
    return static_cast<int>(value);
  };
  const int x = whole(numbers[0]), y = whole(numbers[1]);
  const Size size{whole(numbers[2]), whole(numbers[3])};
  Panorama all{picture.size()};
  // A scan of which nothing is known yet is what the options say once it is cropped.
  const bool known = from_text != Panorama::kName || !picture.projection.empty();
  if (known) {
    const Projection from = projection_of_probe(from_text, picture.projection, picture.size(), source);
    const auto* panorama = std::get_if<Panorama>(&from);
    if (!panorama && !is_plain_latlong(from)) {
      throw Error(
          fmt::format("{}: --crop is for lat-longs and panoramas; of other pictures give --ball or --circle", source));
    }
    if (panorama) all = *panorama;
  }
  const auto part = [&] {
    try {
      return hdr::cropped(all, x, y, size);
    } catch (const Error& error) {
      throw Error(source + ": --" + error.what());
    }
  }();
  const auto copy = [&](const Image<float>& plane) {
    if (plane.empty()) return Image<float>();
    Image<float> result(size, plane.channels());
    for (int row = 0; row < size.height; ++row)
      std::copy_n(plane.pixel(x, y + row), size.width * plane.channels(), result.row(row));
    return result;
  };
  RadianceMap result{copy(picture.rgb),      copy(picture.alpha),     copy(picture.stddev),
                     picture.chromaticities, picture.white_luminance, known ? text_from_projection(part) : ""};
  return result;
}

/// By --level or --horizon; else the identity.
Mat3 level_from_picture(Run& run, const RadianceMap& picture, const Projection& from, const UnwrapFlags& flags,
                        const std::string& source) {
  if (!flags.horizon.empty()) {
    if (flags.level) throw CLI::ValidationError("--horizon", "says what --level would look for; give one of them");
    const std::vector<double> numbers = numbers_from_text(flags.horizon, "--horizon", 0);
    if (numbers.size() % 2 != 0) throw Error("--horizon: give X,Y of each point, pixels");
    std::vector<Vec3> points;
    for (std::size_t k = 0; k < numbers.size(); k += 2) {
      const auto dir = dir_from_px(from, {numbers[k], numbers[k + 1]});
      if (!dir) throw Error(fmt::format("--horizon: {}, {} lies outside of {}", numbers[k], numbers[k + 1], source));
      points.push_back(*dir);
    }
    return level_from_horizon(points);
  }
  if (!flags.level) return Mat3::Identity();
  const auto found = run.stage("level", [&] {
    const int half = std::clamp(picture.size().width, 512, 2048) / 2;
    const Size whole{2 * half, half};
    RadianceMap light;
    light.rgb = picture.rgb.clone();
    light.alpha = picture.alpha.clone();
    const RadianceMap sphere = unwrap(light, from, LatLong{whole}, whole);
    return find_level(sphere.rgb, sphere.alpha);
  });
  if (!found) {
    throw Error(source +
                ": too little in it is vertical to find its level; give --horizon X,Y,X,Y (points on the "
                "horizon) or --rotate");
  }
  run.answer["level"] = {{"tilt_degrees", found->tilt_degrees},
                         {"support", found->support},
                         {"deviation_degrees", found->deviation_degrees}};
  run.say(fmt::format("levelled: it was tilted by {:.2f} +- {:.2f} degrees ({:.0f} % of its lines say so)",
                      found->tilt_degrees, found->deviation_degrees, 100 * found->support));
  return found->level_from_picture;
}

}  // namespace

BallGeometry ball_geometry(Run& run, const RadianceMap& picture, const UnwrapFlags& flags, const std::string& source) {
  const bool geometry_in_from = flags.from.find('=') != std::string::npos;
  const auto named = projection_from_text(geometry_in_from ? flags.from : picture.projection, picture.size());
  const auto* known = named ? std::get_if<MirrorBall>(&*named) : nullptr;
  BallGeometry geometry;
  MirrorBall& ball = geometry.ball;
  if (known) ball = *known;
  if (!known || flags.ball != "auto") {
    // EXIF's field is often a whole number of millimetres: good for a distance, and told nowhere else.
    std::optional<double> camera_fov = flags.camera_fov;
    if (!camera_fov && !flags.distance && !known) {
      camera_fov = camera_field(source, picture.size());
      if (camera_fov)
        run.say(
            fmt::format("{}: its camera's field is {:.1f} degrees, it says; --camera-fov or --distance overrules it",
                        source, *camera_fov));
    }
    if (camera_fov) run.answer["camera_fov"] = *camera_fov;
    geometry = ball_outline(run, picture, flags, camera_fov, source);
    if (known && !flags.camera_fov) ball.distance = known->distance;
  } else if (flags.camera_fov) {
    ball = ball_in_photograph(ball.disc, picture.size(), *flags.camera_fov);
  }
  require_mostly_in_frame(run, ball, picture.size(), source);
  if (!flags.reflectance.empty()) require_reflectance(vec3_from_text(flags.reflectance, "--reflectance").array());
  if (flags.distance) ball.distance = *flags.distance;
  if (!(ball.distance > 1))
    throw Error("--distance: the camera must be outside of the ball, more than 1 radius from its centre");
  geometry.outline_known = known || flags.ball != "auto";
  geometry.distance_known = known || flags.distance || flags.camera_fov;
  constexpr double kNear = 5;  // radii: nearer than that few photograph a ball
  if (std::isinf(ball.distance) && !geometry.distance_known) {
    MirrorBall near = ball;
    near.distance = kNear;
    geometry.direction_doubt_degrees = most_degrees_between(ball, near);
  }
  return geometry;
}

RadianceMap unwrap_picture(Run& run, const RadianceMap& picture, const UnwrapFlags& flags,
                           const std::string& default_from, const std::string& source) {
  const std::string from_text = flags.from_of(picture.projection, default_from);
  if (!flags.crop.empty()) {
    const RadianceMap part = cropped(picture, flags, from_text, source);
    UnwrapFlags whole = flags;
    whole.crop = "";
    if (!part.projection.empty()) whole.from = "";
    return unwrap_picture(run, part, whole, default_from, source);
  }
  Projection from = projection_of_probe(flags.with_field(from_text), picture.projection, picture.size(), source);
  if (std::holds_alternative<MirrorBall>(from)) {
    const BallGeometry geometry = ball_geometry(run, picture, flags, source);
    const MirrorBall& ball = geometry.ball;
    from = ball;
    run.answer["ball"] = {{"cx", ball.disc.cx}, {"cy", ball.disc.cy}, {"r", ball.disc.r}};
    run.answer["ball"]["distance"] = std::isfinite(ball.distance) ? Json(ball.distance) : Json(nullptr);
    say_ball(run, geometry);
  }
  // A field that both pictures could have is that of what is written when the source's own tag has said its own.
  const bool field_is_known = flags.from.empty() && flags.target_has_field();
  flags.apply_to_source(from, !field_is_known);
  if (auto* fisheye = std::get_if<Fisheye>(&from)) {
    const bool known = !picture.projection.empty() || flags.from.find('=') != std::string::npos;
    if (flags.circle == "auto" && !known) fisheye->disc = image_circle(run, picture, source);
    run.answer["circle"] = {{"cx", fisheye->disc.cx}, {"cy", fisheye->disc.cy}, {"r", fisheye->disc.r}};
  }
  const auto [to, size] = flags.target();
  // d_out = R d_in, so what the probe shows in direction d the picture shows in R^-1 d.
  const Mat3 level = level_from_picture(run, picture, from, flags, source);
  const Mat3 picture_from_probe = (rotation_from_degrees(vec3_from_text(flags.rotate, "--rotate")) * level).transpose();
  RadianceMap probe = run.stage("unwrap", [&, &target = to, &target_size = size] {
    const auto* ball = std::get_if<MirrorBall>(&from);
    if (!ball || flags.reflectance.empty()) return unwrap(picture, from, target, target_size, picture_from_probe);
    RadianceMap light = copy_of(picture);
    divide_by_reflectance(light, *ball, vec3_from_text(flags.reflectance, "--reflectance").array());
    return unwrap(light, from, target, target_size, picture_from_probe);
  });
  Json view = {{"from_path", source}, {"probe_from_view", Json::array()}, {"overlap_rms", nullptr}, {"gain", 1.0}};
  const Mat3 probe_from_view = picture_from_probe.transpose();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) view["probe_from_view"].push_back(probe_from_view(r, c));
  }
  run.answer["views"] = Json::array({view});
  run.answer["projection"] = probe.projection;
  return probe;
}

}  // namespace hdr::tools
