#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libhdr/core/rows.h"
#include "libhdr/io/write.h"

namespace hdr::internal {

/// A band of rows of all that an EXR of ours may hold. Views of layers that the file does not have are not looked at.
struct ExrBand {
  View<const float> rgb, alpha, stddev;
  View<const std::uint8_t> flags;
  std::vector<View<const float>> more = {};  ///< of the channels that the writer was made with
};

/// Writes OpenEXR into `file`, a temporary of `path` (the name for messages), as its rows come. Compression works on
/// blocks of lines of its own: the bytes do not depend on the bands. Throws Error.
class ExrWriter {
 public:
  /// `more`: further layers, each with the names of its channels; as float, whatever the options say.
  ExrWriter(const Path& file, const Path& path, const MapHeader& header, bool alpha, const Provenance& provenance,
            const WriteOptions& options, const std::vector<std::vector<std::string>>& more = {});
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
