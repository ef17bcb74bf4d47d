// Photographs from one point, each of a part of the sphere -> the whole of it.
#include "libhdr/probe/stitch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/io/write.h"
#include "libhdr/probe/unwrap.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/stitch_input.h"

namespace hdr::tools {
namespace {

struct Options {
  std::vector<std::string> photos;
  std::string output, rotate = "0,0,0", distortion = "fit", vignetting = "none", seam = "feather";
  std::optional<double> fov;
  int width = 4096;
  bool level = false, nadir = false;
  StitchReading reading;
  WriteFlags write;
};

void declare_options(CLI::App& app, Options& o) {
  app.add_option("photos", o.photos,
                 "photographs or radiance maps that overlap; a folder of shots is merged first; or one folder of all")
      ->required();
  app.add_option("-o,--output", o.output, "the lat-long to write (.exr, .hdr, .tif)")->required();
  app.add_option("--width", o.width, "width to write, pixels")->check(CLI::Range(8, 65536))->capture_default_str();
  app.add_option("--fov", o.fov,
                 "horizontal field of the photographs, degrees, to start from (default: EXIF's focal length for 35 mm, "
                 "else found)")
      ->check(CLI::Range(1.0, 179.0));
  app.add_flag("--level", o.level, "the horizon becomes level (default: the first photograph's axes)");
  app.add_option("--rotate", o.rotate, "X,Y,Z degrees, at last: d_out = Rz Ry Rx d_in")->capture_default_str();
  app.add_flag("--nadir", o.nadir, "fills the hole at the bottom smoothly from its border");
  app.add_option("--seam", o.seam,
                 "feather: along the borders between the photographs; cut: a graph cut, which goes around what moved")
      ->check(CLI::IsMember({"feather", "cut"}))
      ->capture_default_str();
  app.add_option("--distortion", o.distortion, "of the lens: fit (where the photographs call for it) or none")
      ->check(CLI::IsMember({"fit", "none"}))
      ->capture_default_str();
  app.add_option("--vignetting", o.vignetting, "K1,K2,K3 (see unwrap) to divide out; fit: from the overlaps; none")
      ->capture_default_str();
  app.add_option("--response", o.reading.response,
                 "of photographs and brackets: srgb, linear, gamma:2.2, a response file; auto: photographs sRGB, "
                 "brackets fitted to the first")
      ->capture_default_str();
  app.add_flag("--uncertainty", o.reading.uncertainty, "brackets: also the standard deviation of each pixel");
  o.write.declare(app);
}

double share_clipped(const StitchPhoto& photo) {
  if (!std::isfinite(photo.ceiling)) return 0;
  std::size_t clipped = 0;
  for (int y = 0; y < photo.rgb.height(); ++y) {
    for (int x = 0; x < photo.rgb.width(); ++x) {
      const float* p = photo.rgb.pixel(x, y);
      clipped += static_cast<double>(std::max({p[0], p[1], p[2]})) >= photo.ceiling ? 1 : 0;
    }
  }
  return static_cast<double>(clipped) / (static_cast<double>(photo.rgb.width()) * photo.rgb.height());
}

std::vector<StitchInput> read_inputs(Run& run, const Options& o) {
  std::vector<StitchInput> inputs = read_stitch_inputs(run, o.photos, o.reading);
  if (o.vignetting != "none" && o.vignetting != "fit") {
    const Vec3 k = vec3_from_text(o.vignetting, "--vignetting");
    for (StitchInput& input : inputs) divide_vignetting(input.map, {k.x(), k.y(), k.z()});
  }
  return inputs;
}

Json view_row(const std::string& name, const StitchedPhoto& photo, const Mat3& probe_from_stitch) {
  Json row = {{"path", name}, {"from_path", name}, {"used", photo.used}};
  if (!photo.used) {
    row["skipped"] = photo.skipped;
    return row;
  }
  const Mat3 probe_from_view = probe_from_stitch * photo.probe_from_view;
  row["probe_from_view"] = Json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) row["probe_from_view"].push_back(probe_from_view(r, c));
  }
  row["fov"] = photo.lens.fov_degrees;
  row["distortion"] = {photo.lens.distortion.k1, photo.lens.distortion.k2};
  row["gain"] = photo.gain;
  row["residual_px"] = photo.residual_px;
  row["matches"] = photo.matches;
  return row;
}

void answer_views(Run& run, const std::vector<std::string>& names, const Stitch& stitch,
                  const Mat3& probe_from_stitch) {
  Json views = Json::array();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const StitchedPhoto& photo = stitch.photos[k];
    views.push_back(view_row(names[k], photo, probe_from_stitch));
    if (!photo.used) {
      run.warn(names[k] + " is left out: " + photo.skipped);
      run.clock.skipped(names[k] + ": " + photo.skipped);
      continue;
    }
    run.say(fmt::format("{}: field {:.2f} degrees, gain {:.3f}, {} matches within {:.2f} px", names[k],
                        photo.lens.fov_degrees, photo.gain, photo.matches, photo.residual_px));
  }
  run.answer["views"] = std::move(views);
  run.answer["overlap_rms"] = stitch.overlap_rms;
  run.answer["vignetting"] = {stitch.vignetting.k1, stitch.vignetting.k2, stitch.vignetting.k3};
}

double share_shown(const RadianceMap& map) {
  if (map.alpha.empty()) return 1;
  double shown = 0;
  for (int y = 0; y < map.alpha.height(); ++y) {
    double in_row = 0;
    for (int x = 0; x < map.alpha.width(); ++x) in_row += static_cast<double>(map.alpha(x, y));
    shown += in_row * latlong_pixel_solid_angle(y, map.alpha.width(), map.alpha.height());
  }
  return shown / (4 * kPi);
}

void fill_hole(Run& run, RadianceMap& map) {
  const NadirFill fill = run.stage("nadir", [&] { return fill_nadir(map); });
  run.answer["nadir"] = {{"solid_angle", fill.solid_angle}, {"radius_degrees", fill.radius_degrees}};
  if (fill.solid_angle == 0) {
    run.clock.skipped("no hole at the bottom: not a byte changes");
    return;
  }
  run.say(fmt::format("made up: the ground within {:.1f} degrees below, {:.1f} % of the sphere", fill.radius_degrees,
                      100 * fill.solid_angle / (4 * kPi)));
}

/// A clipped sky is too dark, and cannot be told from a right one afterwards.
void warn_of_clipping(Run& run, const std::vector<StitchPhoto>& photos, const std::vector<std::string>& names) {
  constexpr double kTolerated = 0.01;  ///< share of a photograph: lamps and their reflections
  std::size_t clipped = 0, worst = 0;
  double most = 0;
  for (std::size_t k = 0; k < photos.size(); ++k) {
    const double share = share_clipped(photos[k]);
    clipped += share > kTolerated ? 1 : 0;
    if (share > most) {
      most = share;
      worst = k;
    }
  }
  if (clipped == 0) return;
  run.warn(
      fmt::format("{} of {} photographs are overexposed ({:.0f} % of {}): light there is a lower bound; give each as a "
                  "folder of exposures",
                  clipped, photos.size(), 100 * most, names[worst]));
}

int stitch(Run& run, const Options& o) {
  const Mat3 probe_from_stitch = rotation_from_degrees(vec3_from_text(o.rotate, "--rotate"));
  const std::vector<StitchInput> inputs = read_inputs(run, o);
  std::vector<StitchPhoto> photos;
  std::vector<std::string> names;
  for (const StitchInput& input : inputs) {
    names.push_back(input.name);
    photos.push_back(
        {input.map.rgb, input.map.alpha, input.map.stddev, input.ceiling, o.fov ? o.fov : input.fov_degrees});
  }
  const Stitch solved = run.stage("register", [&] {
    return solve_stitch(photos, names, {o.level, o.distortion == "fit", o.vignetting == "fit"});
  });
  answer_views(run, names, solved, probe_from_stitch);
  warn_of_clipping(run, photos, names);
  RadianceMap map = run.stage("join", [&] {
    return merge_stitch(photos, solved, o.width, probe_from_stitch.transpose(),
                        o.seam == "cut" ? Seam::kCut : Seam::kFeather);
  });
  const auto first = static_cast<std::size_t>(
      std::find_if(solved.photos.begin(), solved.photos.end(), [](const StitchedPhoto& p) { return p.used; }) -
      solved.photos.begin());
  map.chromaticities = inputs[first].map.chromaticities;
  map.white_luminance = inputs[first].map.white_luminance;
  run.answer["shown"] = share_shown(map);
  if (o.nadir) fill_hole(run, map);
  if (!map.alpha.empty() && !o.nadir && share_shown(map) < 1) {
    run.warn(fmt::format("the photographs show {:.1f} % of the sphere; the rest has alpha 0", 100 * share_shown(map)));
  }
  run.answer["projection"] = map.projection;
  Provenance provenance = provenance_of(run, Path{});
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : " ") + Path(name).filename().string();
  provenance.add("input", list);
  run.stage("write", [&] { write_map(o.output, map, provenance, o.write.options()); });
  run.say("wrote " + o.output);
  return 0;
}

}  // namespace

std::function<int(Run&)> declare_stitch(CLI::App& app) {
  auto options = std::make_shared<Options>();
  declare_options(app, *options);
  return [options](Run& run) { return stitch(run, *options); };
}

}  // namespace hdr::tools
