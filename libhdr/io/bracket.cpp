#include "libhdr/io/bracket.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/photo_samples.h"
#include "libhdr/core/rows.h"
#include "libhdr/io/internal/bracket_checks.h"
#include "libhdr/io/internal/exif.h"
#include "libhdr/io/internal/photo_file.h"
#include "libhdr/io/internal/scene_check.h"
#include "libhdr/io/output_file.h"

namespace hdr {
namespace {

namespace fs = std::filesystem;
using internal::Brightness;

std::vector<Path> photographs_in(const Path& folder) {
  std::vector<Path> found;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const bool hidden = entry.path().filename().string().starts_with('.');
    if (!hidden && entry.is_regular_file() && is_photo_name(entry.path())) found.push_back(entry.path());
  }
  if (failed)
    throw Error(fmt::format("{}: cannot be read: {}; check its permissions", folder.string(), failed.message()));
  if (found.empty()) throw Error(folder.string() + ": no photographs (.jpg, .png, .tif ...) in this folder");
  std::sort(found.begin(), found.end());
  return found;
}

/// result[i] = work(i), each a task of its own.
template <class T, class Work>
std::vector<T> in_parallel(std::size_t count, const Work& work) {
  std::vector<T> results(count);
  for_rows(static_cast<int>(count), 1, [&](int first, int) {
    const auto i = static_cast<std::size_t>(first);
    results[i] = work(i);
  });
  return results;
}

/// How many shots keep their codes. What is less than the libraries that reading a picture loads is not worth a
/// thought.
std::size_t shots_kept(const std::vector<PhotoHeader>& headers, Size size, std::optional<double> code_bytes_a_pixel) {
  constexpr double kSmall = 64 << 20;
  const double all = static_cast<double>(headers.size());
  const double shot = headers.front().bits <= 8 ? 3 : 6;
  if (!code_bytes_a_pixel || all * shot <= *code_bytes_a_pixel) return headers.size();
  if (all * shot * size.width * size.height <= kSmall) return headers.size();
  return static_cast<std::size_t>(std::max(0.0, 0.5 * *code_bytes_a_pixel / shot));
}

Photo decoded_shot(const Path& path, Size size) {
  Photo shot = internal::decode_photo(path);
  internal::crop(shot, size);
  return shot;
}

Photo shot_to_decode_again(const PhotoHeader& header, Size size) {
  const PhotoSource source{size, [path = header.path, size] { return open_photo_rows(path, size); }};
  return {header.path, header.exposure, header.bits, header.lossy, {}, source, {}};
}

/// --times, in the order of the files, in place of EXIF's times; the apertures and ISO speeds stay.
void replace_times(std::vector<Exposure>& exposures, const std::vector<Path>& paths, const std::vector<double>& times) {
  if (times.empty()) return;
  if (times.size() != exposures.size()) {
    throw Error(fmt::format("--times: {} times for {} shots; give one for each, in the order of the files",
                            times.size(), exposures.size()));
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!(std::isfinite(times[i]) && times[i] > 0)) {
      throw Error(fmt::format("--times: time {} is {} (for {}); times are positive seconds", i + 1, times[i],
                              paths[i].string()));
    }
    exposures[i].seconds = times[i];
  }
}

void require_times(const std::vector<Exposure>& exposures, const std::vector<Path>& paths) {
  for (std::size_t i = 0; i < paths.size(); ++i) {
    internal::require_usable_time(paths[i], exposures[i]);
    if (!exposures[i].seconds) {
      throw Error(paths[i].string() + ": no exposure time in EXIF; pass --times or --exposures");
    }
  }
}

/// The shot that a line of the list means: by file name, else (lists outlive conversions: memorial0061.ppm is a .png
/// today) by a name without extension that only one shot has.
std::optional<std::size_t> shot_named(const std::string& listed, const std::vector<Path>& paths) {
  const Path name(listed);
  const auto same_name = [&](const Path& path) { return path.filename() == name.filename(); };
  const auto same_stem = [&](const Path& path) { return path.stem() == name.stem(); };
  auto found = std::find_if(paths.begin(), paths.end(), same_name);
  if (found == paths.end()) {
    if (std::count_if(paths.begin(), paths.end(), same_stem) != 1) return std::nullopt;
    found = std::find_if(paths.begin(), paths.end(), same_stem);
  }
  return static_cast<std::size_t>(found - paths.begin());
}

/// --exposures: the whole exposure of the shots that the list names.
void replace_by_list(std::vector<Exposure>& exposures, const std::vector<Path>& paths, const Path& list,
                     ListFormat format, const std::vector<Brightness>& brightness) {
  const std::string text = read_text(list);
  // What the second field means may depend on the pictures, so the names come first.
  std::vector<std::optional<double>> means;
  for (const ListedExposure& line : parse_exposure_list(text, list.string(), format)) {
    const auto shot = shot_named(line.name, paths);
    means.push_back(shot ? std::optional(brightness[*shot].mean) : std::nullopt);
  }
  bool any = false;
  for (const ListedExposure& line : parse_exposure_list(text, list.string(), format, means)) {
    const auto shot = shot_named(line.name, paths);
    if (!shot) continue;
    exposures[*shot] = line.exposure;
    any = true;
  }
  if (!any) throw Error(list.string() + ": names none of the shots; check the names in its first column");
}

/// Rising exposure, ties by name; sorts shots and brightness alike.
void sort_by_exposure(Bracket& bracket, std::vector<Brightness>& brightness) {
  std::vector<std::size_t> order(bracket.shots.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Photo &p = bracket.shots[a], &q = bracket.shots[b];
    return std::make_tuple(p.relative_exposure(), p.path.filename(), p.path) <
           std::make_tuple(q.relative_exposure(), q.path.filename(), q.path);
  });
  std::vector<Photo> shots;
  std::vector<Brightness> sorted;
  bracket.input_order.resize(order.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    shots.push_back(std::move(bracket.shots[order[rank]]));
    sorted.push_back(brightness[order[rank]]);
    bracket.input_order[order[rank]] = static_cast<int>(rank);
  }
  bracket.shots = std::move(shots);
  brightness = std::move(sorted);
}

}  // namespace

std::vector<Path> expand_shots(const std::vector<Path>& files_or_folder) {
  if (files_or_folder.empty()) throw Error("no photographs named; name files or a folder");
  std::vector<Path> paths;
  for (const Path& path : files_or_folder) {
    std::error_code failed;
    if (!fs::exists(path, failed)) throw Error(path.string() + ": no such file; check the name");
    if (fs::is_directory(path, failed)) {
      const std::vector<Path> inside = photographs_in(path);
      paths.insert(paths.end(), inside.begin(), inside.end());
    } else {
      paths.push_back(path);
    }
  }
  return paths;
}

Bracket read_bracket(const std::vector<Path>& files_or_folder, const BracketOptions& options) {
  const std::vector<Path> paths = expand_shots(files_or_folder);
  internal::refuse_duplicates(paths);
  const auto headers =
      in_parallel<PhotoHeader>(paths.size(), [&](std::size_t i) { return internal::decode_photo_header(paths[i]); });
  internal::require_one_depth(headers);
  Bracket bracket;
  const Size size = internal::common_size(headers, bracket.warnings);
  std::vector<Exposure> exposures;
  for (const PhotoHeader& header : headers) exposures.push_back(header.exposure);
  replace_times(exposures, paths, options.times);
  if (!options.exposures) require_times(exposures, paths);  // before anything is decoded

  const std::size_t kept = shots_kept(headers, size, options.code_bytes_a_pixel);
  bracket.shots = in_parallel<Photo>(paths.size(), [&](std::size_t i) {
    return i < kept ? decoded_shot(paths[i], size) : shot_to_decode_again(headers[i], size);
  });
  std::vector<internal::SceneThumbnail> thumbnails(paths.size());
  auto brightness = in_parallel<Brightness>(paths.size(), [&](std::size_t i) {
    Photo& shot = bracket.shots[i];
    const std::shared_ptr<const PhotoSamples> samples = samples_of(shot);
    if (!shot.in_memory()) shot.samples = samples;
    thumbnails[i] = internal::thumbnail_of(*samples, shot.max_code());
    return internal::brightness_of(*samples, shot.max_code());
  });
  if (options.exposures) {
    replace_by_list(exposures, paths, *options.exposures, options.list_format, brightness);
    replace_times(exposures, paths, options.times);
    require_times(exposures, paths);
  }
  for (std::size_t i = 0; i < paths.size(); ++i) bracket.shots[i].exposure = exposures[i];

  internal::settle_missing_settings(bracket.shots, bracket.warnings);
  if (!options.allow_equal_exposures) internal::require_different_exposures(bracket.shots);
  sort_by_exposure(bracket, brightness);
  internal::refuse_contradicted_times(bracket.shots, brightness);
  std::vector<internal::SceneThumbnail> rising(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i) {
    rising[static_cast<std::size_t>(bracket.input_order[i])] = std::move(thumbnails[i]);
  }
  if (const auto stranger = internal::stranger_among(bracket.shots, rising)) {
    if (!options.expects_motion) throw Error(*stranger + "; leave it out");
    bracket.warnings.push_back(*stranger + "; what of it agrees with others is used");
  }
  return bracket;
}

}  // namespace hdr
