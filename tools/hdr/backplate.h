#pragma once
// A photograph as the background of a composite: linear light in, and the same codes out where nothing changed.
#include <optional>
#include <string>

#include "libhdr/core/radiance.h"
#include "libhdr/io/write.h"
#include "libhdr/response/response.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

class Backplate {
 public:
  /// A map as it is; a picture from sRGB, or through `response` (a file, or a name) when that is not empty: then the
  /// brightest code of green is radiance 1. `width`: resampled to this width; 0: as it is. Throws Error.
  Backplate(Run& run, const std::string& path, const std::string& response, int width);

  View<const float> light() const { return light_.rgb; }
  Size size() const { return light_.size(); }

  /// Maps by write_map. Pictures (.png, .jpg): through the response again, or as sRGB; of a map through the tone
  /// mapper, metered, and the stops are said.
  void write(Run& run, const std::string& path, const RadianceMap& picture, const Provenance& provenance,
             const WriteOptions& options) const;

 private:
  RadianceMap light_;
  bool is_map_ = false;
  std::optional<Response> response_;
};

}  // namespace hdr::tools
