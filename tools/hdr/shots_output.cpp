#include "tools/hdr/shots_output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "libhdr/core/error.h"
#include "libhdr/io/dng.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/write.h"
#include "libhdr/response/response.h"

namespace hdr::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kList = "bracket.json";

void remove_earlier_shots(const Path& folder) {
  const Path list = folder / kList;
  if (!fs::exists(list)) return;
  const Json bracket = Json::parse(read_text(list), nullptr, false);
  if (bracket.is_discarded() || !bracket.contains("files")) return;
  for (const Json& name : bracket["files"]) {
    std::error_code ignored;
    if (name.is_string()) fs::remove(folder / Path(name.get<std::string>()).filename(), ignored);
  }
}

[[noreturn]] void refuse(const Path& folder, const std::error_code& reason) {
  throw Error(fmt::format("{}: cannot be made: {}; choose another folder", folder.string(), reason.message()));
}

/// `folder` and what is missing above it; the new ones, outermost first.
std::vector<Path> made_folders(const Path& folder) {
  std::vector<Path> made;
  Path above;
  std::error_code failed;
  for (const Path& part : folder) {
    above /= part;
    if (fs::is_directory(above, failed)) continue;
    if (!fs::create_directory(above, failed) || failed) {
      if (!failed) failed = std::make_error_code(std::errc::not_a_directory);
      for (auto it = made.rbegin(); it != made.rend(); ++it) fs::remove(*it);
      refuse(folder, failed);
    }
    made.push_back(above);
  }
  return made;
}

/// Removes what is there of these, innermost first; folders that are not empty stay.
void unmake(const std::vector<Path>& folders) {
  std::error_code ignored;
  for (auto it = folders.rbegin(); it != folders.rend(); ++it) fs::remove(*it, ignored);
}

}  // namespace

ShotsOutput::ShotsOutput(Path folder) : folder_(std::move(folder)) {
  if (folder_.filename().empty()) folder_ = folder_.parent_path();  // written with a slash at its end
  made_ = made_folders(folder_);
  hidden_ = folder_ / fmt::format(".{}.tmp", getpid());
  std::error_code failed;
  fs::create_directory(hidden_, failed);
  if (failed) {
    unmake(made_);
    refuse(folder_, failed);
  }
}

ShotsOutput::~ShotsOutput() {
  std::error_code ignored;
  fs::remove_all(hidden_, ignored);
  unmake(made_);
}

Path ShotsOutput::next(const std::string& extension, double seconds, const Row& row) {
  const std::string name = fmt::format("shot_{:02d}.{}", names_.size(), extension);
  names_.push_back(name);
  rows_.push_back({{"path", (folder_ / name).string()},
                   {"requested_seconds", row.requested_seconds},
                   {"seconds", seconds},
                   {"verified", name_of(row.verified)},
                   {"sequence", row.sequence}});
  return hidden_ / name;
}

void ShotsOutput::write(const Photo& photo, const Row& row, const std::string& format, int jpeg_quality,
                        std::optional<double> fov_degrees) {
  write_photo(next(format, photo.exposure.seconds.value(), row), photo, jpeg_quality, fov_degrees);
}

void ShotsOutput::write(const Frame& frame, const DevelopOptions& optics, const std::string& camera,
                        const std::string& format, int jpeg_quality) {
  const PixelFormat pixels = frame.format.pixels;
  const bool raw = is_bayer(pixels), jpeg = pixels == PixelFormat::kMjpeg;
  const std::string extension = format != "auto" ? format : raw ? "dng" : jpeg ? "jpg" : "png";
  const Exposure exposure = exposure_of(frame, optics);
  const Path path =
      next(extension, exposure.seconds.value(), {frame.requested.seconds, frame.verified, frame.sequence});
  if (extension == "dng") {
    write_dng(path, mosaic_from(frame, optics), camera);
  } else if (extension == "jpg" && jpeg) {
    write_jpeg(path, frame.bytes, exposure);
  } else {
    write_photo(path, develop(frame, optics), jpeg_quality);
  }
}

void ShotsOutput::commit(const Json& bracket) {
  write_text(hidden_ / kList, bracket.dump(1) + "\n");
  remove_earlier_shots(folder_);
  std::vector<Path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(hidden_)) files.push_back(entry.path().filename());
  std::partition(files.begin(), files.end(), [](const Path& name) { return name != kList; });  // the list comes last
  for (const Path& name : files) {
    std::error_code failed;
    fs::rename(hidden_ / name, folder_ / name, failed);
    if (failed) refuse(folder_ / name, failed);
  }
}

std::optional<std::string> response_of_folder(const std::vector<Path>& shots) {
  const Path folder = shots.front().parent_path();
  if (!fs::exists(folder / kList)) return std::nullopt;
  const Json bracket = Json::parse(read_text(folder / kList), nullptr, false);
  if (!bracket.is_object() || !bracket.contains("files") || !bracket.contains("response")) return std::nullopt;
  const Json &files = bracket["files"], &response = bracket["response"];
  if (!files.is_array() || !response.is_string()) return std::nullopt;
  for (const Path& shot : shots) {
    const bool listed = std::find(files.begin(), files.end(), Json(shot.filename().string())) != files.end();
    if (!listed || shot.parent_path() != folder) return std::nullopt;
  }
  const std::string text = response.get<std::string>();
  constexpr int kAnyBits = 8;
  return response_from_name(text, kAnyBits) ? text : (folder / text).string();
}

}  // namespace hdr::tools
