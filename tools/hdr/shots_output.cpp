#include "tools/hdr/shots_output.h"

#include <fmt/format.h>

#include <filesystem>

#include "libhdr/core/error.h"
#include "libhdr/io/output_file.h"
#include "libhdr/io/write.h"

namespace hdr::tools {
namespace {

void remove_earlier_shots(const Path& folder) {
  const Path list = folder / "bracket.json";
  if (!std::filesystem::exists(list)) return;
  const Json bracket = Json::parse(read_text(list), nullptr, false);
  if (bracket.is_discarded() || !bracket.contains("files")) return;
  for (const Json& name : bracket["files"]) {
    std::error_code ignored;
    if (name.is_string()) std::filesystem::remove(folder / Path(name.get<std::string>()).filename(), ignored);
  }
}

}  // namespace

ShotsOutput::ShotsOutput(Path folder) : folder_(std::move(folder)) {
  std::error_code failed;
  std::filesystem::create_directories(folder_, failed);
  if (failed)
    throw Error(fmt::format("{}: cannot be made: {}; choose another folder", folder_.string(), failed.message()));
  remove_earlier_shots(folder_);
}

void ShotsOutput::write(const Photo& photo, const Row& row, const std::string& format, int jpeg_quality) {
  const std::string name = fmt::format("shot_{:02d}.{}", names_.size(), format);
  write_photo(folder_ / name, photo, jpeg_quality);
  names_.push_back(name);
  rows_.push_back({{"path", (folder_ / name).string()},
                   {"requested_seconds", row.requested_seconds},
                   {"seconds", *photo.exposure.seconds},
                   {"verified", name_of(row.verified)},
                   {"sequence", row.sequence}});
}

void ShotsOutput::write_json(const Json& bracket) const {
  write_text(folder_ / "bracket.json", bracket.dump(1) + "\n");
}

}  // namespace hdr::tools
