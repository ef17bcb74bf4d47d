#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/filter/compare.h"
#include "libhdr/io/read.h"
#include "libhdr/probe/projection.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {
namespace {

/// For lat-long probes made from a ball: 0 within `degrees` of +Z (the photographer) and -Z (the blind spot behind the
/// ball).
Image<std::uint8_t> outside_cones(Size size, double degrees) {
  Image<std::uint8_t> mask(size, 1);
  const double limit = std::cos(degrees * kDegree);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Vec3 d = dir_from_latlong((x + 0.5) / size.width, (y + 0.5) / size.height);
      mask(x, y) = std::abs(d.z()) < limit;
    }
  }
  return mask;
}

CompareScale scale_from_name(const std::string& name) {
  if (name == "global") return CompareScale::kGlobal;
  if (name == "channel") return CompareScale::kChannel;
  return CompareScale::kNone;
}

}  // namespace

std::function<int(Run&)> declare_diff(CLI::App& app) {
  struct Options {
    std::string a, b, scale = "none";
    std::optional<double> tolerance, cone;
  };
  auto options = std::make_shared<Options>();
  app.add_option("a", options->a, "a map")->required();
  app.add_option("b", options->b, "the map it should be")->required();
  app.add_option("--scale", options->scale, "remove a factor first: one for the map, or one a channel")
      ->check(CLI::IsMember({"none", "global", "channel"}))
      ->capture_default_str();
  app.add_option("--tolerance", options->tolerance,
                 "exit 1 when rel_rmse is above this, or a sample of A is not finite");
  app.add_option(
      "--ignore-cones", options->cone,
      "lat-long maps: ignore directions within this many degrees of +Z and -Z, the photographer and the blind "
      "spot of a ball");
  return [options](Run& run) {
    const ReadMap a = read_map(options->a, {NonFinite::kKeep}), b = read_map(options->b, {NonFinite::kKeep});
    if (a.map.size() != b.map.size()) {
      throw Error(fmt::format("{} is {}x{} and {} is {}x{}; bring them to one size with hdr unwrap --width", options->a,
                              a.map.rgb.width(), a.map.rgb.height(), options->b, b.map.rgb.width(),
                              b.map.rgb.height()));
    }
    Image<std::uint8_t> mask;
    for (const ReadMap* map : {&a, &b}) {
      for (const std::string& warning : map->warnings) run.warn(warning);
    }
    if (options->cone) {
      const Projection projection = projection_of_probe("", a.map.projection, a.map.size(), options->a);
      if (!is_plain_latlong(projection)) throw Error(options->a + ": --ignore-cones needs lat-long maps");
      mask = outside_cones(a.map.size(), *options->cone);
    }
    const Comparison result =
        run.clock.run("diff", [&] { return compare(a.map.rgb, b.map.rgb, scale_from_name(options->scale), mask); });
    run.answer["rel_rmse"] = result.rel_rmse;
    run.answer["median_abs_log2"] = result.median_abs_log2;
    run.answer["p99_abs_log2"] = result.p99_abs_log2;
    run.answer["max_abs"] = result.max_abs;
    run.answer["nonfinite"] = result.nonfinite;
    run.answer["scale"] = result.scale;
    run.say(
        fmt::format("rel rmse {:.4g}   median |log2| {:.4f}   p99 {:.4f}   max {:.4g}   not finite {} {}   scale "
                    "{:.4g} {:.4g} {:.4g}",
                    result.rel_rmse, result.median_abs_log2, result.p99_abs_log2, result.max_abs, result.nonfinite[0],
                    result.nonfinite[1], result.scale[0], result.scale[1], result.scale[2]));
    const bool beyond = options->tolerance && (!(result.rel_rmse <= *options->tolerance) || result.nonfinite[0] > 0);
    return beyond ? 1 : 0;
  };
}

}  // namespace hdr::tools
