#include "libhdr/io/internal/bracket_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "libhdr/core/error.h"
#include "libhdr/io/exposure_list.h"

namespace hdr::internal {
namespace {

using Setting = std::optional<double> Exposure::*;

/// Returns how many shots have the setting, after dropping one that is not known for all.
std::size_t settle(std::vector<Photo>& shots, Setting setting, const char* name, std::vector<std::string>& warnings) {
  const auto has = [&](const Photo& shot) { return (shot.exposure.*setting).has_value(); };
  const auto known = static_cast<std::size_t>(std::count_if(shots.begin(), shots.end(), has));
  if (known > 0 && known < shots.size()) {
    for (Photo& shot : shots) shot.exposure.*setting = std::nullopt;
    warnings.push_back(fmt::format("only {} of {} shots have {}; it is taken as constant", known, shots.size(), name));
  }
  return known;
}

}  // namespace

void refuse_duplicates(const std::vector<Path>& paths) {
  std::map<Path, Path> first_name;
  for (const Path& path : paths) {
    std::error_code failed;
    const auto [known, is_new] = first_name.emplace(std::filesystem::weakly_canonical(path, failed), path);
    if (is_new) continue;
    throw Error(fmt::format("{}: named twice{}; name each shot once", path.string(),
                            known->second == path ? "" : " (also as " + known->second.string() + ")"));
  }
}

Size common_size(const std::vector<PhotoHeader>& headers, std::vector<std::string>& warnings) {
  const PhotoHeader& first = headers.front();
  Size smallest = first.size, largest = first.size;
  for (const PhotoHeader& other : headers) {
    smallest = {std::min(smallest.width, other.size.width), std::min(smallest.height, other.size.height)};
    largest = {std::max(largest.width, other.size.width), std::max(largest.height, other.size.height)};
    constexpr double kTrimmed = 1.05;
    if (largest.width > kTrimmed * smallest.width || largest.height > kTrimmed * smallest.height) {
      throw Error(fmt::format("{}: {}x{} pixels, but {} has {}x{}; the shots of a bracket have one size",
                              other.path.string(), other.size.width, other.size.height, first.path.string(),
                              first.size.width, first.size.height));
    }
  }
  if (smallest != largest) {
    warnings.push_back(fmt::format("the shots are up to {}x{} pixels; their top left {}x{} are used", largest.width,
                                   largest.height, smallest.width, smallest.height));
  }
  return smallest;
}

void crop(Photo& photo, Size size) {
  if (photo.size() == size) return;
  std::visit(
      [size](auto& codes) {
        std::decay_t<decltype(codes)> cropped(size, codes.channels());
        for (int y = 0; y < size.height; ++y) std::copy_n(codes.row(y), cropped.row_samples(), cropped.row(y));
        codes = std::move(cropped);
      },
      photo.codes);
}

void require_one_depth(const std::vector<PhotoHeader>& headers) {
  const PhotoHeader& first = headers.front();
  for (const PhotoHeader& other : headers) {
    if (other.bits != first.bits) {
      throw Error(fmt::format("{}: {} bits, but {} has {}; the shots of a bracket have one depth", other.path.string(),
                              other.bits, first.path.string(), first.bits));
    }
  }
}

void settle_missing_settings(std::vector<Photo>& shots, std::vector<std::string>& warnings) {
  const std::size_t apertures = settle(shots, &Exposure::f_number, "an aperture", warnings);
  const std::size_t isos = settle(shots, &Exposure::iso, "an ISO speed", warnings);
  if (shots.size() < 2 || (apertures > 0 && isos > 0)) return;
  const char* missing = isos > 0 ? "aperture" : apertures > 0 ? "ISO speed" : "aperture and no ISO speed";
  warnings.push_back(fmt::format("no {} in EXIF or the list; taken as constant", missing));
}

void require_different_exposures(const std::vector<Photo>& shots) {
  if (shots.size() < 2) return;
  const auto less = [](const Photo& a, const Photo& b) { return a.relative_exposure() < b.relative_exposure(); };
  const auto [shortest, longest] = std::minmax_element(shots.begin(), shots.end(), less);
  constexpr double kSame = 1.001;
  if (longest->relative_exposure() > kSame * shortest->relative_exposure()) return;
  throw Error(fmt::format("{}: all {} shots have the same exposure {}: EXIF may be stale; pass --times or --exposures",
                          shots.front().path.string(), shots.size(),
                          text_from_seconds(*shots.front().exposure.seconds)));
}

void refuse_contradicted_times(const std::vector<Photo>& shots, const std::vector<Brightness>& brightness) {
  constexpr double kThirdOfAStop = 1.2599;  // the finest step of a camera's dial: less may drown in flicker
  for (std::size_t longer = 0; longer < shots.size(); ++longer) {
    for (std::size_t shorter = 0; shorter < longer; ++shorter) {
      const Photo &a = shots[longer], &b = shots[shorter];
      if (a.relative_exposure() < 0.99 * kThirdOfAStop * b.relative_exposure()) continue;
      if (!darker_throughout(brightness[longer], brightness[shorter])) continue;
      throw Error(
          fmt::format("{} ({}): darker throughout than {} ({}), though exposed longer; check EXIF, or the order "
                      "of --times",
                      a.path.string(), text_from_seconds(*a.exposure.seconds), b.path.string(),
                      text_from_seconds(*b.exposure.seconds)));
    }
  }
}

}  // namespace hdr::internal
