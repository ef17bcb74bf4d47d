#pragma once
#include <OpenImageIO/filesystem.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr::internal {

/// A JPEG for OpenImageIO, read from the disk as it is decoded (a bracket's files together may be larger than the map),
/// in which ICC profiles cannot be recognised: OpenImageIO 2.4 reads beyond the end of some that real cameras write,
/// and crashes now and then; we have no use for them. `profiles` says where their signatures begin.
std::unique_ptr<OIIO::Filesystem::IOProxy> jpeg_without_profiles(const Path& path, std::vector<std::size_t> profiles);

}  // namespace hdr::internal
