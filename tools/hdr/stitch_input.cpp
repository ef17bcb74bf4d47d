#include "tools/hdr/stitch_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "libhdr/core/error.h"
#include "libhdr/io/map_scale.h"
#include "libhdr/io/read.h"
#include "libhdr/probe/projection.h"
#include "tools/hdr/pipeline.h"

namespace hdr::tools {
namespace {

bool is_folder(const Path& path) {
  std::error_code failed;
  return std::filesystem::is_directory(path, failed);
}

bool is_map_name(const Path& path) {
  static constexpr std::array kExtensions = {".exr", ".hdr", ".pfm"};
  return std::find(kExtensions.begin(), kExtensions.end(), path.extension().string()) != kExtensions.end();
}

/// Folders in it, when there are any, else pictures, by name.
std::vector<std::string> inside(const std::string& folder) {
  std::vector<std::string> folders, files;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    const Path& path = entry.path();
    if (is_folder(path)) {
      folders.push_back(path.string());
    } else if (is_photo_name(path) || is_map_name(path)) {
      files.push_back(path.string());
    }
  }
  if (failed) throw Error(folder + ": cannot read this folder (" + failed.message() + ")");
  std::vector<std::string>& found = folders.empty() ? files : folders;
  std::sort(found.begin(), found.end());
  if (found.empty()) throw Error(folder + ": no photographs in this folder; give photographs that overlap");
  return found;
}

/// Merges brackets, and photographs whose response is given, all in the unit of the first.
class Merger {
 public:
  Merger(Run& run, const StitchReading& reading) : run_(run) {
    options_.merge.response = reading.response;
    options_.merge.uncertainty = reading.uncertainty;
  }

  RadianceMap merge(const std::string& shots) {
    options_.shots.files = {shots};
    const MergeInputs inputs = prepare_merge(run_, options_);
    options_.given_response = inputs.response;
    options_.given_unit = inputs.options.exposure_unit;
    return merge_shots(run_, inputs).map;
  }

 private:
  Run& run_;
  MergePipelineOptions options_;
};

/// Codes of 8 bits end at 255; a little below, light is lost already.
constexpr double kCeiling = 0.98;

StitchInput read_picture(Run& run, const std::string& name) {
  ReadMap read = run.stage("read", [&] { return read_map(name); });
  StitchInput input{name, std::move(read.map)};
  if (const std::string& tag = input.map.projection; !tag.empty()) {
    const auto projection = projection_from_text(tag, input.map.size());
    const auto* camera = projection ? std::get_if<Rectilinear>(&*projection) : nullptr;
    if (!camera) {
      throw Error(fmt::format("{}: shows the sphere as {}, not as a photograph; hdr unwrap --to rectilinear makes one",
                              name, tag));
    }
    input.fov_degrees = camera->fov_degrees;
  }
  if (!is_photo_name(name)) {
    if (!input.fov_degrees) input.fov_degrees = read_camera_fov(name, input.map.size());
    for (const std::string& warning : read.warnings) run.warn(warning);
    return input;
  }
  float most = 0;
  for (int y = 0; y < input.map.rgb.height(); ++y) {
    const float* row = input.map.rgb.row(y);
    most = std::max(most, *std::max_element(row, row + input.map.rgb.row_samples()));
  }
  if (most <= 1) input.ceiling = kCeiling;  // codes, not floats in a TIFF
  return input;
}

}  // namespace

std::vector<StitchInput> read_stitch_inputs(Run& run, const std::vector<std::string>& photos,
                                            const StitchReading& reading) {
  const bool folder_alone = photos.size() == 1 && is_folder(photos.front());
  const std::vector<std::string> names = folder_alone ? inside(photos.front()) : photos;
  const bool response_given = reading.response != "auto" && reading.response != "fit";
  Merger merger(run, reading);
  std::vector<StitchInput> inputs;
  for (const std::string& name : names) {
    const bool photograph = is_photo_name(name);
    if (is_folder(name)) {
      StitchInput input{name, merger.merge(name)};
      input.fov_degrees = read_photo_header(expand_shots({name}).front()).fov_degrees;
      inputs.push_back(std::move(input));
      continue;
    }
    inputs.push_back(photograph && response_given ? StitchInput{name, merger.merge(name)} : read_picture(run, name));
    if (photograph && !inputs.back().fov_degrees) inputs.back().fov_degrees = read_photo_header(name).fov_degrees;
  }
  return inputs;
}

}  // namespace hdr::tools
