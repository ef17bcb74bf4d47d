#pragma once
#include <memory>

#include "libhdr/core/rows.h"
#include "libhdr/io/write.h"

namespace hdr::internal {

/// A band of rows of all that an EXR of ours may hold. Views of layers that the file does not have are not looked at.
struct ExrBand {
  View<const float> rgb, alpha, stddev;
  View<const std::uint8_t> flags;
};

/// Writes OpenEXR into `file`, a temporary of `path` (the name for messages), as its rows come. Compression works on
/// blocks of lines of its own: the bytes do not depend on the bands. Throws Error.
class ExrWriter {
 public:
  ExrWriter(const Path& file, const Path& path, const MapHeader& header, bool alpha, const Provenance& provenance,
            const WriteOptions& options);
  ~ExrWriter();
  /// The next rows.
  void put(const ExrBand& band);
  /// After the last row. Throws Error when samples were beyond half's range.
  void finish();

 private:
  class File;
  Path path_;
  std::unique_ptr<File> file_;
};

}  // namespace hdr::internal
