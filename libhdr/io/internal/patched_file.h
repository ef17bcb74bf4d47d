#pragma once
// A picture file as OpenImageIO is to see it: colour profiles (ICC) hidden. OpenImageIO 2.4 trusts the lengths inside a
// profile, and a damaged one kills it; nothing here needs profiles, which describe how to show a picture.
#include <OpenImageIO/filesystem.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr::internal {

/// One byte that reads as another.
struct Patch {
  std::int64_t offset = 0;
  char value = 0;
};

/// The file with its patches. Throws Error when it cannot be opened.
std::unique_ptr<OIIO::Filesystem::IOProxy> patched_file(const Path& path, std::vector<Patch> patches);

/// Patches that make the profile tags of a TIFF or BigTIFF, and the iCCP chunks of a PNG, unknown ones. Throws Error
/// where the chain of a TIFF's directories leaves the file, with the place.
std::vector<Patch> patches_of_tiff(const Path& path);
std::vector<Patch> patches_of_png(const Path& path);

}  // namespace hdr::internal
