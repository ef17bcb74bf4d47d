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

/// What the shots of a bracket have at one set of places. A shot may have to be decoded for it, so whoever decodes one
/// for something else lets others look at it, too.
class CodesAtPlaces {
 public:
  /// `ref_from_photo` may be empty: registered.
  CodesAtPlaces(const Bracket& bracket, const std::vector<Mat3>& ref_from_photo, std::vector<SamplePlace> places);

  /// Looks at shot j, of which `photo` has the codes. Different shots may be looked at by different threads.
  void look_at(std::size_t j, const Photo& photo);
  /// Looks at all shots.
  void look_at(const Bracket& bracket);

  const std::vector<SamplePlace>& places() const { return places_; }
  /// codes()[channel][i * shots + j]: the code of the pixel of shot j nearest to place i; -1 outside the frame.
  const std::array<std::vector<int>, 3>& codes() const { return codes_; }

 private:
  Size size_;
  std::size_t shots_;
  std::vector<Mat3> ref_from_photo_;
  std::vector<SamplePlace> places_;
  std::array<std::vector<int>, 3> codes_;
};

/// Where shot j shows the places: nearest pixels, (-1, -1) outside the frame.
std::vector<SamplePlace> places_in_photo(const std::vector<SamplePlace>& places, const Mat3* ref_from_photo, Size size);

}  // namespace hdr::internal
