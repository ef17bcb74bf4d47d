#pragma once
// The checks of read_bracket, one function a rule. Each throws Error, or adds to the warnings.
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/io/internal/brightness.h"
#include "libhdr/io/read.h"

namespace hdr::internal {

void refuse_duplicates(const std::vector<Path>& paths);
void require_one_depth(const std::vector<PhotoHeader>& headers);

/// The size of all shots. Shots that were trimmed by hand differ by a few pixels: up to 5 % they share their smallest
/// width and height, with a warning; beyond that they are no bracket.
Size common_size(const std::vector<PhotoHeader>& headers, std::vector<std::string>& warnings);

/// Keeps the top left corner, so that pixel coordinates stay.
void crop(Photo& photo, Size size);

/// An aperture (or ISO) that only some shots have is dropped for all; one that none has is taken as constant.
void settle_missing_settings(std::vector<Photo>& shots, std::vector<std::string>& warnings);

/// Expects a time for every shot.
void require_different_exposures(const std::vector<Photo>& shots);

/// `shots` rise in exposure; brightness[i] belongs to shots[i].
void refuse_contradicted_times(const std::vector<Photo>& shots, const std::vector<Brightness>& brightness);

}  // namespace hdr::internal
