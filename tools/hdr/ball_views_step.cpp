#include "tools/hdr/ball_views_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/io/read.h"
#include "libhdr/probe/ball_views.h"
#include "libhdr/probe/reflectance.h"
#include "tools/hdr/unwrap_step.h"

namespace hdr::tools {
namespace {

struct Picture {
  RadianceMap map;
  Image<float> mask;
  BallGeometry geometry;
};

Image<float> read_mask(const std::string& path, Size size) {
  const ReadMap read = read_map(path);
  if (read.map.size() != size) {
    throw Error(fmt::format("{}: the mask has {}x{} pixels, its picture {}x{}; draw it over the picture", path,
                            read.map.size().width, read.map.size().height, size.width, size.height));
  }
  Image<float> mask(size, 1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) mask(x, y) = read.map.rgb(x, y, 1) >= 0.2f ? 1.0f : 0.0f;
  }
  return mask;
}

Json ball_row(const MirrorBall& ball) {
  return {{"cx", ball.disc.cx},
          {"cy", ball.disc.cy},
          {"r", ball.disc.r},
          {"distance", std::isfinite(ball.distance) ? Json(ball.distance) : Json(nullptr)}};
}

std::vector<Picture> read_pictures(Run& run, const std::vector<std::string>& images,
                                   const std::vector<std::string>& masks, const UnwrapFlags& flags) {
  if (!masks.empty() && masks.size() != images.size()) {
    throw Error(fmt::format("--mask: {} masks for {} pictures; give one for each in their order, - for none",
                            masks.size(), images.size()));
  }
  std::vector<Picture> pictures;
  for (std::size_t k = 0; k < images.size(); ++k) {
    ReadMap read = run.stage("read", [&] { return read_map(images[k]); });
    for (const std::string& warning : read.warnings) run.warn(warning);
    Picture picture{std::move(read.map), {}, {}};
    picture.geometry = ball_geometry(run, picture.map, flags, images[k]);
    if (!masks.empty() && masks[k] != "-") picture.mask = read_mask(masks[k], picture.map.size());
    if (!flags.reflectance.empty()) {
      divide_by_reflectance(picture.map, picture.geometry.ball,
                            vec3_from_text(flags.reflectance, "--reflectance").array());
    }
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

/// Whoever stands behind the camera stays where no view from elsewhere shows what he hides.
void warn_of_cameras_in_one_place(Run& run, const std::vector<std::string>& images,
                                  const std::vector<RegisteredView>& registered) {
  constexpr double kApart = 25;  ///< degrees
  double widest = 0;
  for (const RegisteredView& a : registered) {
    for (const RegisteredView& b : registered) {
      const double cosine = (a.probe_from_view * Vec3::UnitZ()).dot(b.probe_from_view * Vec3::UnitZ());
      widest = std::max(widest, std::acos(std::clamp(cosine, -1.0, 1.0)) / kDegree);
    }
  }
  if (widest >= kApart) return;
  run.warn(
      fmt::format("{}: all views are within {:.0f} degrees: the photographer stays in the sphere; take one from "
                  "the side, best 90 degrees away",
                  images.back(), widest));
}

void answer_views(Run& run, const std::vector<std::string>& images, const std::vector<RegisteredView>& registered,
                  const Mat3& probe_from_first) {
  Json views = Json::array();
  for (std::size_t k = 0; k < images.size(); ++k) {
    const RegisteredView& view = registered[k];
    const Mat3 probe_from_view = probe_from_first * view.probe_from_view;
    Json row = {{"from_path", images[k]}, {"probe_from_view", Json::array()}};
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) row["probe_from_view"].push_back(probe_from_view(r, c));
    }
    row["overlap_rms"] = view.overlap_rms;
    row["gain"] = view.gain;
    row["correlation"] = view.correlation;
    row["runner_up"] = k == 0 ? Json(nullptr) : Json(view.runner_up);
    row["ball"] = ball_row(view.ball);
    run.say(fmt::format("{}: turned {:.2f} degrees, gain {:.3f}, overlap rms {:.3f} (ln)", images[k],
                        Eigen::AngleAxisd(view.probe_from_view).angle() / kDegree, view.gain, view.overlap_rms));
    if (k > 0 && view.ambiguous())
      run.warn(
          fmt::format("{}: the place looks alike from two sides: turned otherwise it fits nearly as well "
                      "(correlation {:.2f} and {:.2f}); look at the sphere, or take a view from between",
                      images[k], view.correlation, view.runner_up));
    views.push_back(std::move(row));
  }
  warn_of_cameras_in_one_place(run, images, registered);
  run.answer["ball"] = ball_row(registered.front().ball);
  run.answer["views"] = std::move(views);
}

}  // namespace

RadianceMap unwrap_ball_views(Run& run, const std::vector<std::string>& images, const std::vector<std::string>& masks,
                              const UnwrapFlags& flags) {
  const std::vector<Picture> pictures = read_pictures(run, images, masks, flags);
  std::vector<BallView> views;
  for (const Picture& picture : pictures)
    views.push_back({picture.map.rgb, picture.geometry.ball, picture.geometry.outline_known,
                     picture.geometry.distance_known, picture.mask, picture.map.stddev});
  const std::vector<RegisteredView> registered =
      run.stage("register", [&] { return register_ball_views(views, images); });
  // d_out = R d_in, so what the probe shows in direction d the first view shows in R^-1 d.
  const Mat3 probe_from_first = rotation_from_degrees(vec3_from_text(flags.rotate, "--rotate"));
  answer_views(run, images, registered, probe_from_first);
  const auto [to, size] = flags.target();
  RadianceMap probe = run.stage("join", [&, &target = to, &target_size = size] {
    return join_ball_views(views, registered, target, target_size, probe_from_first.transpose());
  });
  probe.chromaticities = pictures.front().map.chromaticities;
  probe.white_luminance = pictures.front().map.white_luminance;
  run.answer["projection"] = probe.projection;
  return probe;
}

}  // namespace hdr::tools
