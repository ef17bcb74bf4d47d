#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <optional>

#include "libhdr/core/color.h"
#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/internal/map_samples.h"
#include "libhdr/io/internal/oiio.h"
#include "libhdr/io/internal/orientation.h"
#include "libhdr/io/internal/radiance_header.h"
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

void divide(Image<float>& image, double factor) {
  for_rows(image.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      float* row = image.row(y);
      for (std::size_t i = 0; i < image.row_samples(); ++i) row[i] = static_cast<float>(row[i] / factor);
    }
  });
}

struct Oddities {
  std::int64_t nan = 0, infinite = 0, negative = 0, finite = 0;
  float largest = 0;
};

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
void sanitise(Image<float>& image, const std::string& name, std::vector<std::string>& warnings) {
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
  warnings.push_back(fmt::format("{}: {} NaN and {} negative samples became 0, {} infinite ones {}", name, odd.nan,
                                 odd.negative, odd.infinite, odd.largest));
}

Chromaticities chromaticities_of(const OIIO::ImageSpec& spec) {
  Chromaticities xy;
  const OIIO::ParamValue* found = spec.find_attribute("chromaticities");
  if (!found || found->type().basetype != OIIO::TypeDesc::FLOAT || found->type().numelements() < 8) return xy;
  const auto* v = static_cast<const float*>(found->data());
  for (int i = 0; i < 2; ++i) {
    xy.red[i] = v[i];
    xy.green[i] = v[2 + i];
    xy.blue[i] = v[4 + i];
    xy.white[i] = v[6 + i];
  }
  return xy;
}

std::optional<double> white_luminance_of(const OIIO::ImageSpec& spec) {
  const double value = spec.get_float_attribute("whiteLuminance", 0);
  return value > 0 && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

ReadMap read_map(const Path& path, NonFinite non_finite) try {
  const auto input = internal::open_picture(path);
  const OIIO::ImageSpec spec = input->spec();
  const std::string name = path.string();
  ReadMap result;
  RadianceMap& map = result.map;

  const ChannelPlan plan = internal::plan_channels(spec, path);
  if (!plan.note.empty()) result.warnings.push_back(name + ": " + plan.note);
  internal::read_samples(*input, plan, path, map);
  if (!spec.format.is_floating_point()) {
    linearise(map);
    result.warnings.push_back(name + ": integer samples, taken as sRGB and made linear; highlights are clipped at 1");
  }
  if (std::string(input->format_name()) == "hdr") divide(map.rgb, internal::radiance_exposure(path));
  if (non_finite == NonFinite::kReplace) {
    if (count_oddities(map.rgb).finite == 0) {
      throw Error(name + ": all samples are NaN or infinite; the program that wrote it failed, make it again");
    }
    sanitise(map.rgb, name, result.warnings);
    if (!map.alpha.empty()) sanitise(map.alpha, name + " (alpha)", result.warnings);
    if (!map.stddev.empty()) sanitise(map.stddev, name + " (stddev)", result.warnings);
  }

  internal::place_in_display_window(map, spec, name, result.warnings);
  const int orientation = internal::orientation_of(spec);
  for (Image<float>* plane : {&map.rgb, &map.alpha, &map.stddev}) {
    *plane = internal::upright(std::move(*plane), orientation);
  }
  map.chromaticities = chromaticities_of(spec);
  map.white_luminance = white_luminance_of(spec);
  internal::take_projection(map, spec, name, result.warnings);
  return result;
} catch (const std::bad_alloc&) {
  throw Error(path.string() + ": does not fit in memory; scale it down");
}

}  // namespace hdr
