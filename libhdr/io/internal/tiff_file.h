#pragma once
// libtiff's files: opened with a limit on what it may allocate, and with its complaints kept instead of printed.
#include <tiffio.h>

#include <memory>
#include <string>

#include "libhdr/core/photo.h"

namespace hdr::internal {

class TiffFile {
 public:
  /// `mode` as libtiff has it. The file need not be a TIFF: then get() is nullptr.
  TiffFile(const Path& path, const char* mode);
  ~TiffFile();
  TiffFile(const TiffFile&) = delete;
  TiffFile& operator=(const TiffFile&) = delete;

  TIFF* get() const { return tiff_; }
  /// What libtiff complained of last.
  const std::string& complaint() const { return complaint_; }
  /// Writes what is left and closes; false when it did not fit.
  bool close();

 private:
  TIFF* tiff_ = nullptr;
  std::string complaint_;
};

/// A field of one value, or `otherwise`.
template <class T>
T tiff_field(TIFF* tiff, std::uint32_t tag, T otherwise) {
  T value{};
  return TIFFGetFieldDefaulted(tiff, tag, &value) == 1 ? value : otherwise;
}

}  // namespace hdr::internal
