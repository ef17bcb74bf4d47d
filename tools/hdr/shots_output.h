#pragma once
// A folder of shots: photographs with their exposures in EXIF, and bracket.json. Such a folder is SHOTS for every verb.
#include <string>

#include "capture/frame.h"
#include "libhdr/core/photo.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

class ShotsOutput {
 public:
  /// Makes the folder; throws Error when it cannot be made. Shots that an earlier run left there, as its bracket.json
  /// lists them, are removed: the folder is SHOTS, and two scenes would be merged.
  explicit ShotsOutput(Path folder);

  /// What the answer says of a shot, besides its path.
  struct Row {
    double requested_seconds = 0;
    Verified verified = Verified::kNone;
    std::uint32_t sequence = 0;
  };
  /// Writes shot_NN.FORMAT.
  void write(const Photo& photo, const Row& row, const std::string& format, int jpeg_quality);
  void write_json(const Json& bracket) const;

  const Json& names() const { return names_; }
  const Json& rows() const { return rows_; }  ///< the answer's frames

 private:
  Path folder_;
  Json names_ = Json::array(), rows_ = Json::array();
};

}  // namespace hdr::tools
