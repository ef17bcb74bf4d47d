#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <optional>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/internal/map_samples.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/orientation.h"
#include "libhdr/io/internal/rec709.h"
#include "libhdr/io/internal/sphere_file.h"
#include "libhdr/io/read.h"

namespace hdr {
namespace {

using internal::ChannelPlan;
constexpr int kGrain = 16;

/// Integer files hold sRGB codes: [0,1] codes become linear light, and then alpha is multiplied in, as in EXR.
void linearise(RadianceMap& map) {
  for_rows(map.rgb.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < map.rgb.width(); ++x) {
        const double coverage = map.alpha.empty() ? 1.0 : map.alpha(x, y);
        float* rgb = map.rgb.pixel(x, y);
        for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>(coverage * linear_from_srgb(rgb[c]));
      }
    }
  });
}

struct Oddities {
  std::int64_t nan = 0, infinite = 0, negative = 0, finite = 0;
  float largest = 0;
};

/// Whether all samples are finite and none is negative, which is what most maps have: as unsigned integers such floats
/// are those up to the largest. A third of the time of counting.
bool is_all_light(const Image<float>& image) {
  constexpr std::uint32_t kLargest = 0x7f7fffff;
  const auto of_rows = [&](int first, int last) {
    int good = 1;  // no bool: the parts of a reduction are separate objects
    for (int y = first; y < last && good; ++y) {
      const float* row = image.row(y);
      std::uint32_t beyond = 0;
      for (std::size_t k = 0; k < image.row_samples(); ++k) {
        beyond |= static_cast<std::uint32_t>(std::bit_cast<std::uint32_t>(row[k]) > kLargest);
      }
      good = beyond == 0 ? 1 : 0;
    }
    return good;
  };
  return reduce_rows(image.height(), kGrain, 1, of_rows, [](int& all, int part) { all &= part; }) == 1;
}

Oddities count_oddities(const Image<float>& image) {
  const auto of_rows = [&](int first, int last) {
    Oddities found;
    for (int y = first; y < last; ++y) {
      for (const float* v = image.row(y); v != image.row(y) + image.row_samples(); ++v) {
        if (std::isnan(*v)) {
          ++found.nan;
        } else if (std::isinf(*v) && *v > 0) {
          ++found.infinite;
        } else if (*v < 0) {
          ++found.negative;
        } else {
          ++found.finite;
          found.largest = std::max(found.largest, *v);
        }
      }
    }
    return found;
  };
  return reduce_rows(image.height(), kGrain, Oddities{}, of_rows, [](Oddities& total, const Oddities& part) {
    total.nan += part.nan;
    total.infinite += part.infinite;
    total.negative += part.negative;
    total.finite += part.finite;
    total.largest = std::max(total.largest, part.largest);
  });
}

/// Light is finite and not negative: NaN and negative samples become 0, infinities the largest finite sample.
void sanitise(Image<float>& image, const std::string& name, std::vector<std::string>& warnings, const char* why) {
  if (is_all_light(image)) return;
  const Oddities odd = count_oddities(image);
  if (odd.nan == 0 && odd.infinite == 0 && odd.negative == 0) return;
  for_rows(image.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (float* v = image.row(y); v != image.row(y) + image.row_samples(); ++v) {
        if (!(*v >= 0)) *v = 0;
        if (std::isinf(*v)) *v = odd.largest;
      }
    }
  });
  warnings.push_back(fmt::format("{}: {} NaN and {} negative samples{} became 0, {} infinite ones {}", name, odd.nan,
                                 odd.negative, why, odd.infinite, odd.largest));
}

void require_light(const RadianceMap& map, const std::string& name) {
  if (is_all_light(map.rgb) || count_oddities(map.rgb).finite > 0) return;
  throw Error(name + ": all samples are NaN, infinite or negative; the program that wrote it failed, make it again");
}

/// Integer samples: those of raw files are linear already, others are taken as sRGB.
void make_linear(RadianceMap& map, const OIIO::ImageInput& input, const std::string& name,
                 std::vector<std::string>& warnings) {
  const std::string format = input.format_name();
  if (format == "dng" || format == "raw") {
    warnings.push_back(name + ": a raw photograph: linear, in the camera's own primaries");
    return;
  }
  linearise(map);
  warnings.push_back(name + ": integer samples, taken as sRGB and made linear; highlights are clipped at 1");
}

std::optional<double> white_luminance_of(const OIIO::ImageSpec& spec) {
  const double value = spec.get_float_attribute("whiteLuminance", 0);
  return value > 0 && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

ReadMap read_map(const Path& path, const ReadMapOptions& options) try {
  const auto input = internal::open_picture(path, options.mantissa);
  const OIIO::ImageSpec spec = input->spec();
  const std::string name = path.string();
  ReadMap result;
  RadianceMap& map = result.map;

  const ChannelPlan plan = internal::plan_channels(spec, path);
  if (!plan.note.empty()) result.warnings.push_back(name + ": " + plan.note);
  internal::read_samples(*input, plan, path, map);
  if (!spec.format.is_floating_point()) make_linear(map, *input, name, result.warnings);
  map.chromaticities = internal::chromaticities_of(spec);
  const bool convert = options.primaries == Primaries::kRec709 && !internal::is_rec709(map.chromaticities);
  if (options.non_finite == NonFinite::kReplace) {
    require_light(map, name);
    // Before primaries are mixed, so that a NaN in one channel spoils no other.
    if (convert) sanitise(map.rgb, name, result.warnings, "");
  }
  if (convert) {
    internal::convert_to_rec709(map);
    result.warnings.push_back(name + ": its primaries were converted to Rec. 709");
  }
  if (options.non_finite == NonFinite::kReplace) {
    sanitise(map.rgb, name, result.warnings, convert ? " (colours outside Rec. 709)" : "");
    if (!map.alpha.empty()) sanitise(map.alpha, name + " (alpha)", result.warnings, "");
    if (!map.stddev.empty()) sanitise(map.stddev, name + " (stddev)", result.warnings, "");
  }

  internal::place_in_display_window(map, spec, name, result.warnings);
  const int orientation = internal::orientation_of(spec);
  for (Image<float>* plane : {&map.rgb, &map.alpha, &map.stddev}) {
    *plane = internal::upright(std::move(*plane), orientation);
  }
  map.white_luminance = white_luminance_of(spec);
  internal::take_projection(map, spec, name, result.warnings);
  return result;
} catch (const std::bad_alloc&) {
  throw Error(path.string() + ": does not fit in memory; scale it down");
}

}  // namespace hdr
