#pragma once
// Places of the scene that stand for all of it, and the codes that the shots have there.
#include <array>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"

namespace hdr::internal {

/// A place on the reference grid: pixel (x, y), whole numbers.
struct SamplePlace {
  int x, y;
};

/// About `count` places, one in each cell of a regular grid but somewhere in it, so that no pattern of the scene (nor
/// JPEG's blocks) is met in step. The same for the same size.
std::vector<SamplePlace> jittered_places(Size size, int count);

/// codes[channel][i * shots + j]: the code of the pixel of shot j nearest to place i; -1 outside the frame.
/// `ref_from_photo` may be empty: registered.
std::array<std::vector<int>, 3> codes_at_places(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo,
                                                const std::vector<SamplePlace>& places);

/// Where shot j shows the places: nearest pixels, (-1, -1) outside the frame.
std::vector<SamplePlace> places_in_photo(const std::vector<SamplePlace>& places, const Mat3* ref_from_photo, Size size);

}  // namespace hdr::internal
