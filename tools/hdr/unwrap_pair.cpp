#include "tools/hdr/unwrap_pair.h"

#include <fmt/format.h>

#include <algorithm>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/probe/find_image_circle.h"
#include "libhdr/probe/fisheye_pair.h"
#include "libhdr/probe/unwrap.h"

namespace hdr::tools {
namespace {

constexpr double kUsualField = 190;  ///< of the lenses of such cameras

/// What is known of a lens: its own tag, the options, the circle that is found.
Fisheye guess(Run& run, const RadianceMap& picture, const UnwrapFlags& flags, const std::string& name) {
  Projection from = projection_of_probe(flags.from_of(picture.projection), picture.projection, picture.size(), name);
  const bool tagged = picture.projection.starts_with(Fisheye::kName);
  const bool geometry_given = tagged || flags.from.find('=') != std::string::npos;
  if (!geometry_given) std::get<Fisheye>(from).fov_degrees = kUsualField;
  flags.apply_to_source(from, true);
  Fisheye lens = std::get<Fisheye>(from);
  if (geometry_given || flags.circle != "auto") return lens;
  const auto found = run.stage("find circle", [&] { return find_image_circle(picture.rgb); });
  if (!found) throw Error(name + ": no image circle found; pass --circle CX,CY,R (pixels, y down)");
  lens.disc = found->disc;
  return lens;
}

Json numbers_of(const Mat3& m) {
  Json numbers = Json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) numbers.push_back(m(r, c));
  }
  return numbers;
}

}  // namespace

bool are_fisheye_pair(const std::vector<const RadianceMap*>& pictures, const UnwrapFlags& flags) {
  if (pictures.size() != 2) return false;
  return std::all_of(pictures.begin(), pictures.end(), [&](const RadianceMap* p) {
    const std::string from = flags.from_of(p->projection);
    return (from.empty() ? p->projection : from).starts_with(Fisheye::kName);
  });
}

RadianceMap unwrap_fisheye_pair(Run& run, const RadianceMap& front, const RadianceMap& back, const UnwrapFlags& flags,
                                const std::vector<std::string>& names) {
  const Fisheye a = guess(run, front, flags, names[0]), b = guess(run, back, flags, names[1]);
  const FisheyePair pair = run.stage("register", [&] {
    try {
      return solve_fisheye_pair(front.rgb, back.rgb, a, b);
    } catch (const Error& error) {
      throw Error(names[0] + ", " + names[1] + ": " + error.what());
    }
  });
  const auto [to, size] = flags.target();
  const Mat3 pair_from_probe = rotation_from_degrees(vec3_from_text(flags.rotate, "--rotate")).transpose();
  // Anything but a lat-long goes through one that is as fine.
  const bool latlong = is_plain_latlong(to);
  const int width = latlong ? size.width : std::max(size.width, 2 * size.height);
  const PairMergeOptions options{flags.seam == "cut" ? Seam::kCut : Seam::kFeather};
  RadianceMap sphere = run.stage("merge", [&] {
    return merge_fisheye_pair({front.rgb, front.stddev}, {back.rgb, back.stddev}, pair, width, pair_from_probe,
                              options);
  });
  sphere.chromaticities = front.chromaticities;
  sphere.white_luminance = front.white_luminance;
  run.answer["circle"] = {
      {"cx", pair.views[0].lens.disc.cx}, {"cy", pair.views[0].lens.disc.cy}, {"r", pair.views[0].lens.disc.r}};
  run.answer["views"] = Json::array();
  for (std::size_t v = 0; v < 2; ++v) {
    const PairView& view = pair.views[v];
    run.answer["views"].push_back({{"from_path", names[v]},
                                   {"probe_from_view", numbers_of(pair_from_probe.transpose() * view.probe_from_view)},
                                   {"overlap_rms", pair.overlap_rms},
                                   {"gain", view.gain},
                                   {"lens", text_from_projection(view.lens)}});
  }
  run.answer["matches"] = pair.matches;
  run.answer["residual_degrees"] = pair.residual_degrees;
  run.say(fmt::format("{} common features, {:.3f} degrees apart (rms); the second picture times {:.3f}", pair.matches,
                      pair.residual_degrees, pair.views[1].gain));
  if (!latlong) {
    sphere = run.stage("unwrap", [&, &target = to, &target_size = size] {
      return unwrap(sphere, LatLong{sphere.size()}, target, target_size);
    });
  }
  run.answer["projection"] = sphere.projection;
  return sphere;
}

}  // namespace hdr::tools
