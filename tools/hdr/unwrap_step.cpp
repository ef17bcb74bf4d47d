#include "tools/hdr/unwrap_step.h"

#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/find_ball.h"
#include "libhdr/probe/unwrap.h"

namespace hdr::tools {
namespace {

Disc ball_disc(Run& run, const RadianceMap& picture, const UnwrapFlags& flags, const std::string& source) {
  if (flags.ball != "auto") {
    const Vec3 numbers = vec3_from_text(flags.ball, "--ball");
    if (!(numbers.z() > 0)) throw Error("--ball: the radius must be positive; give CX,CY,R in pixels");
    const Disc disc{numbers.x(), numbers.y(), numbers.z()};
    const Size size = picture.size();
    if (disc.cx + disc.r <= 0 || disc.cy + disc.r <= 0 || disc.cx - disc.r >= size.width ||
        disc.cy - disc.r >= size.height) {
      throw Error(fmt::format("--ball: {} lies outside of the {}x{} picture", flags.ball, size.width, size.height));
    }
    return disc;
  }
  const auto found = run.stage("find ball", [&] { return find_ball(picture.rgb); });
  if (!found) throw Error(source + ": no mirror ball found; pass --ball CX,CY,R (pixels, y down)");
  run.answer["ball_support"] = found->support;
  run.answer["ball_residual_px"] = found->residual_px;
  return found->disc;
}

/// The geometry that the picture's own tag gives, else --ball or the search.
MirrorBall ball_projection(Run& run, const RadianceMap& picture, const UnwrapFlags& flags, const std::string& source) {
  MirrorBall ball;
  const auto tagged = projection_from_text(picture.projection, picture.size());
  const auto* tag = tagged ? std::get_if<MirrorBall>(&*tagged) : nullptr;
  if (tag) ball = *tag;
  if (!tag || flags.ball != "auto") ball.disc = ball_disc(run, picture, flags, source);
  if (flags.distance) ball.distance = *flags.distance;
  if (!(ball.distance > 1))
    throw Error("--distance: the camera must be outside of the ball, more than 1 radius from its centre");
  return ball;
}

}  // namespace

RadianceMap unwrap_picture(Run& run, const RadianceMap& picture, const UnwrapFlags& flags,
                           const std::string& default_from, const std::string& source) {
  const std::string from_text = flags.from.empty() && picture.projection.empty() ? default_from : flags.from;
  Projection from = projection_of_probe(from_text, picture.projection, picture.size(), source);
  if (std::holds_alternative<MirrorBall>(from)) {
    const MirrorBall ball = ball_projection(run, picture, flags, source);
    from = ball;
    run.answer["ball"] = {{"cx", ball.disc.cx}, {"cy", ball.disc.cy}, {"r", ball.disc.r}};
    run.say(fmt::format("ball: centre {:.2f}, {:.2f}, radius {:.2f} px", ball.disc.cx, ball.disc.cy, ball.disc.r));
  }
  if (auto* view = std::get_if<Rectilinear>(&from); view && flags.fov) view->fov_degrees = *flags.fov;
  const auto [to, size] = flags.target();
  // d_out = R d_in, so what the probe shows in direction d the picture shows in R^-1 d.
  const Mat3 picture_from_probe = rotation_from_degrees(vec3_from_text(flags.rotate, "--rotate")).transpose();
  RadianceMap probe = run.stage("unwrap", [&, &target = to, &target_size = size] {
    return unwrap(picture, from, target, target_size, picture_from_probe);
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
