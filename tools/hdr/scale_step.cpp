#include "tools/hdr/scale_step.h"

#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/sphere.h"
#include "libhdr/light/horizontal_irradiance.h"
#include "libhdr/probe/projection.h"
#include "libhdr/probe/unwrap.h"

namespace hdr::tools {
namespace {

/// Mean luminance of the pixels whose centres lie in the patch. Warns of a patch that is no patch.
double mean_luminance(Run& run, const Patch& patch, View<const float> rgb) {
  double sum = 0, squares = 0;
  std::int64_t count = 0;
  const int top = static_cast<int>(std::clamp(patch.cy - patch.r, 0.0, 1.0 * rgb.height()));
  const int bottom = static_cast<int>(std::clamp(patch.cy + patch.r + 1, 0.0, 1.0 * rgb.height()));
  for (int y = top; y < bottom; ++y) {
    for (int x = 0; x < rgb.width(); ++x) {
      if (std::hypot(x + 0.5 - patch.cx, y + 0.5 - patch.cy) > patch.r) continue;
      const double l = luminance<double>(rgb(x, y, 0), rgb(x, y, 1), rgb(x, y, 2));
      sum += l;
      squares += l * l;
      ++count;
    }
  }
  if (count == 0) {
    throw Error(fmt::format("--patch: no pixel of the {}x{} map has its centre in the disc; give CX,CY,R in pixels",
                            rgb.width(), rgb.height()));
  }
  const double mean = sum / static_cast<double>(count);
  if (!(mean > 0)) throw Error("--patch: the disc is black in the merged map; choose a brighter patch");
  const double spread = std::sqrt(std::max(0.0, squares / static_cast<double>(count) - mean * mean)) / mean;
  constexpr double kUniform = 0.1;
  if (spread > kUniform) {
    run.warn(fmt::format("--patch: its luminance varies by {:.0f} %; is it all of one surface?", 100 * spread));
  }
  return mean;
}

double luminance_of_patch(const Patch& patch, const std::optional<double>& lux) {
  // A matte surface sends out what falls on it evenly: L = rho E / pi.
  return patch.luminance ? *patch.luminance : *patch.reflectance * lux.value() / kPi;
}

RadianceMap as_latlong(const RadianceMap& probe) {
  const Projection projection = projection_of_probe("", probe.projection, probe.size(), "--lux");
  if (std::holds_alternative<Rectilinear>(projection)) {
    throw Error("--lux: a rectilinear view is a part of the sphere; write the probe with --to latlong");
  }
  constexpr Size kSize{512, 256};
  return unwrap(probe, projection, LatLong{kSize}, kSize, Mat3::Identity());
}

}  // namespace

MapScale scale_like(const ScaleFlags& flags) {
  if (flags.scale_like.empty()) return {};
  MapScale scale = read_map_scale(flags.scale_like);
  if (!scale.exposure_unit) {
    throw Error(flags.scale_like +
                ": no hdr:exposure_unit in its header, so its unit is unknown; merge it again with hdr");
  }
  return scale;
}

std::string text_from_terms(const ExposureTerms& terms) {
  std::string text = terms.seconds ? "seconds" : "";
  if (terms.f_number) text += " f_number";
  if (terms.iso) text += " iso";
  return text;
}

void require_same_terms(const ScaleFlags& flags, const MapScale& like, const Bracket& bracket) {
  const std::string terms = text_from_terms(exposure_terms(bracket));
  if (flags.scale_like.empty() || like.exposure_terms.empty() || like.exposure_terms == terms) return;
  throw Error(
      fmt::format("{}: its exposures are known by '{}', those of {} by '{}', so the units differ; pass "
                  "--exposures with the same columns for both",
                  flags.scale_like, like.exposure_terms, bracket.shots.front().path.string(), terms));
}

std::optional<double> known_white_luminance(const ScaleFlags& flags, const MapScale& like, const Bracket& bracket,
                                            double exposure_unit) {
  if (flags.cd_per_unit) return flags.cd_per_unit;
  if (!flags.patch.empty() || flags.lux) return std::nullopt;
  if (like.white_luminance) return like.white_luminance;
  return white_luminance(bracket, exposure_unit);
}

double white_luminance_of_patch(Run& run, const ScaleFlags& flags, View<const float> map) {
  const Patch patch = patch_from_text(flags.patch);
  return luminance_of_patch(patch, flags.lux) / mean_luminance(run, patch, map);
}

void scale_by_lux(Run& run, const ScaleFlags& flags, RadianceMap& probe, RadianceMap& map) {
  if (!flags.lux || !flags.patch.empty()) return;
  const auto* whole = probe.projection.starts_with(LatLong::kName) ? &probe : nullptr;
  const Rgb irradiance = horizontal_irradiance(whole ? whole->rgb.view() : as_latlong(probe).rgb.view());
  const double unit = luminance(irradiance[0], irradiance[1], irradiance[2]);
  if (!(unit > 0)) throw Error("--lux: the upper half of the probe is black; check --rotate, +Y is up");
  probe.white_luminance = map.white_luminance = *flags.lux / unit;
  answer_white_luminance(run, probe.white_luminance);
}

void answer_white_luminance(Run& run, const std::optional<double>& white_luminance) {
  if (!white_luminance) return;
  run.answer["white_luminance"] = *white_luminance;
  run.say(fmt::format("white: radiance 1 is {:.4g} cd/m^2", *white_luminance));
}

}  // namespace hdr::tools
