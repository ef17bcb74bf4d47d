#pragma once
// A folder of shots: photographs with their exposures in EXIF, and bracket.json. Such a folder is SHOTS for every verb.
#include <optional>
#include <string>
#include <vector>

#include "capture/develop.h"
#include "capture/frame.h"
#include "libhdr/core/photo.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

/// Nothing half-written: all is written into a hidden folder, and in its place after commit() alone.
class ShotsOutput {
 public:
  /// Throws Error when the folder cannot be made or written.
  explicit ShotsOutput(Path folder);
  ~ShotsOutput();  ///< without commit() nothing is left
  ShotsOutput(const ShotsOutput&) = delete;
  ShotsOutput& operator=(const ShotsOutput&) = delete;

  /// What the answer says of a shot, besides its path.
  struct Row {
    double requested_seconds = 0;
    Verified verified = Verified::kNone;
    std::uint32_t sequence = 0;
  };
  /// Writes shot_NN.FORMAT. `fov_degrees`: the lens's horizontal field, for EXIF.
  void write(const Photo& photo, const Row& row, const std::string& format, int jpeg_quality,
             std::optional<double> fov_degrees = {});
  /// The same for a frame: "dng" keeps a sensor's codes, "jpg" a camera's own JPEG as it is, and "auto" chooses these
  /// where they apply, else PNG.
  void write(const Frame& frame, const DevelopOptions& optics, const std::string& camera, const std::string& format,
             int jpeg_quality);
  /// Where another file of the folder is to be written.
  Path place(const std::string& name) const { return hidden_ / name; }

  /// Writes bracket.json and puts all files in their place. Shots that an earlier run left there, as its bracket.json
  /// lists them, are removed: the folder is SHOTS, and two scenes would be merged.
  void commit(const Json& bracket);

  const Json& names() const { return names_; }
  const Json& rows() const { return rows_; }  ///< the answer's frames

 private:
  Path next(const std::string& extension, double seconds, const Row& row);

  Path folder_, hidden_;
  std::vector<Path> made_;  ///< folders that were not there, outermost first
  Json names_ = Json::array(), rows_ = Json::array();
};

/// What bracket.json says of the response of these shots ("response": linear, srgb, gamma:2.2, or a file beside it), if
/// they all stand in its folder and in its list.
std::optional<std::string> response_of_folder(const std::vector<Path>& shots);

}  // namespace hdr::tools
