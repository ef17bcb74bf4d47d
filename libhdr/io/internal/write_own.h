#pragma once
// Writers of the formats that OpenImageIO 2.4 does not write, or not exactly. Each writes into `file`, a temporary of
// `path` (the name for messages), rows from the top; nothing is complete before finish(). All throw Error.
#include <memory>

#include "libhdr/io/write.h"

namespace hdr::internal {

class RowsOut {
 public:
  virtual ~RowsOut() = default;
  /// The next rows, RGB. May change them: they are the caller's copy.
  virtual void put(View<float> rows) = 0;
  virtual void finish() = 0;
};

/// Radiance RGBE, run lengths as Radiance's own fwritescan makes them, mantissas rounded to the nearest.
std::unique_ptr<RowsOut> write_radiance(const Path& file, const Path& path, const MapHeader& header);

/// "PF", or "Pf" for luminance alone; little endian.
std::unique_ptr<RowsOut> write_pfm(const Path& file, const Path& path, const MapHeader& header, bool grey);

/// pixarlog, logluv, logluv24 or logl [Larson98], through libtiff.
bool is_log_compression(const std::string& compression);
std::unique_ptr<RowsOut> write_log_tiff(const Path& file, const Path& path, const MapHeader& header,
                                        const std::string& compression);

}  // namespace hdr::internal
