#include "libhdr/io/internal/tiff_file.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <filesystem>

namespace hdr::internal {
namespace {

int keep_complaint(TIFF*, void* complaint, const char*, const char* format, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, format, arguments);
  *static_cast<std::string*>(complaint) = text;
  return 1;
}

int keep_quiet(TIFF*, void*, const char*, const char*, va_list) {
  return 1;
}

}  // namespace

TiffFile::TiffFile(const Path& path, const char* mode) {
  // No tag, strip or tile is honestly larger than this: one that says so is damaged.
  constexpr tmsize_t kLargest = tmsize_t{1} << 31;
  const std::unique_ptr<TIFFOpenOptions, void (*)(TIFFOpenOptions*)> options(TIFFOpenOptionsAlloc(),
                                                                             TIFFOpenOptionsFree);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), kLargest);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_complaint, &complaint_);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), keep_quiet, nullptr);
  tiff_ = TIFFOpenExt(path.c_str(), mode, options.get());
}

TiffFile::~TiffFile() {
  if (tiff_) TIFFClose(tiff_);
}

bool TiffFile::close() {
  const bool flushed = TIFFFlush(tiff_) == 1;
  TIFFClose(tiff_);
  tiff_ = nullptr;
  return flushed;
}

}  // namespace hdr::internal
