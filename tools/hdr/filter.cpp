#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/filter/blur.h"
#include "tools/hdr/image_input.h"
#include "tools/hdr/options.h"
#include "tools/hdr/pipeline.h"

namespace hdr::tools {
namespace {

struct Motion {
  double length = 0, degrees = 0;
};

/// "LENGTH@DEG"; the angle may be left out: 0.
Motion motion_from_text(const std::string& text) {
  char* end = nullptr;
  Motion motion;
  motion.length = std::strtod(text.c_str(), &end);
  bool good = end != text.c_str();
  if (good && *end == '@') {
    const char* angle = end + 1;
    char* angle_end = nullptr;
    motion.degrees = std::strtod(angle, &angle_end);
    good = angle_end != angle;
    end = angle_end;
  }
  if (!good || *end != '\0' || !std::isfinite(motion.length) || !std::isfinite(motion.degrees) || motion.length < 0) {
    throw CLI::ValidationError("--motion",
                               "'" + text + "' is not LENGTH@DEG, pixels and degrees such as 40@0 or 12.5@30");
  }
  return motion;
}

void scale(Image<float>& image, double factor) {
  for_rows(image.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      float* row = image.row(y);
      for (std::size_t k = 0; k < image.row_samples(); ++k) row[k] = static_cast<float>(row[k] * factor);
    }
  });
}

/// Exposure: the numbers change, and with them what (1,1,1) means in cd/m^2; the light does not.
void expose(RadianceMap& map, double stops) {
  const double factor = std::exp2(stops);
  scale(map.rgb, factor);
  scale(map.stddev, factor);
  if (map.white_luminance) *map.white_luminance /= factor;
}

/// Of colour and coverage alike; a blurred standard deviation is none.
template <class Blur>
void blur_planes(RadianceMap& map, const Blur& blur) {
  map.rgb = blur(map.rgb.view());
  if (!map.alpha.empty()) map.alpha = blur(map.alpha.view());
  map.stddev = {};
}

struct Options {
  std::string image, output, motion, from;
  std::optional<double> gaussian, stops;
  WriteFlags write;
};

void declare_options(CLI::App& app, Options& options) {
  app.add_option("image", options.image, "a radiance map, or a picture (made linear first)")->required();
  app.add_option("-o,--output", options.output, "a map (.exr, .hdr, .pfm, .tif) or a picture (.png, .jpg)")->required();
  app.add_option("--gaussian", options.gaussian, "Gaussian blur, sigma in pixels (on a lat-long: of its equator)");
  app.add_option("--motion", options.motion,
                 "motion blur LENGTH@DEG: pixels, degrees counter-clockwise from the right");
  app.add_option("--stops", options.stops, "exposure: multiplies by 2^STOPS");
  app.add_option(
         "--from", options.from,
         "latlong: a map of the sphere, whose left meets its right; plane: a plain picture (default: what the file "
         "says, else plane)")
      ->check(CLI::IsMember({"latlong", "plane"}));
  options.write.declare(app);
}

int filter(Run& run, const Options& options) {
  if (!options.gaussian && options.motion.empty() && !options.stops) {
    throw CLI::ValidationError("nothing to do", "give --gaussian SIGMA, --motion LENGTH@DEG or --stops S");
  }
  if (options.gaussian && !(std::isfinite(*options.gaussian) && *options.gaussian >= 0)) {
    throw CLI::ValidationError("--gaussian", "sigma is a number of pixels from 0 on");
  }
  if (options.stops && !std::isfinite(*options.stops)) throw CLI::ValidationError("--stops", "give a finite number");
  const std::optional<Motion> motion =
      options.motion.empty() ? std::nullopt : std::optional(motion_from_text(options.motion));
  RadianceMap map = read_image(run, options.image);
  const bool tagged = map.projection.starts_with("latlong");
  const Surface surface =
      options.from == "latlong" || (tagged && options.from.empty()) ? Surface::kLatLong : Surface::kPlane;
  if (options.from.empty() && !tagged && map.rgb.width() == 2 * map.rgb.height() && (options.gaussian || motion)) {
    run.warn(options.image +
             ": 2:1 but not marked as a lat-long: blurred as a plain picture; --from latlong wraps it around");
  }
  if (options.stops) run.stage("stops", [&] { expose(map, *options.stops); });
  if (options.gaussian) {
    run.stage("gaussian", [&] {
      blur_planes(map, [&](View<const float> plane) { return gaussian_blur(plane, *options.gaussian, surface); });
    });
  }
  if (motion) {
    run.stage("motion", [&] {
      blur_planes(
          map, [&](View<const float> plane) { return motion_blur(plane, motion->length, motion->degrees, surface); });
    });
  }
  run.answer["surface"] = surface == Surface::kLatLong ? "latlong" : "plane";
  write_image(run, options.output, map, provenance_of(run, Path(options.image)), options.write.options());
  return 0;
}

}  // namespace

std::function<int(Run&)> declare_filter(CLI::App& app) {
  auto options = std::make_shared<Options>();
  declare_options(app, *options);
  return [options](Run& run) { return filter(run, *options); };
}

}  // namespace hdr::tools
