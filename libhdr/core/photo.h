#pragma once
// A photograph as the camera wrote it: integer codes through an unknown response. The type is the colour tag: codes
// live in a Photo, linear radiance in a RadianceMap (core/radiance.h), and only response/ and merge/ turn one into the
// other.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "libhdr/core/exposure.h"
#include "libhdr/core/image.h"

namespace hdr {

using Path = std::filesystem::path;
using Codes = std::variant<Image<std::uint8_t>, Image<std::uint16_t>>;

class PhotoRows;      // core/rows.h
struct PhotoSamples;  // core/photo_samples.h

/// Where the codes of a photograph can be had again, from any thread, as often as they are needed.
struct PhotoSource {
  Size size;
  std::function<std::unique_ptr<PhotoRows>()> open;  ///< empty: there is no other place than Photo::codes
};

/// The codes need not be in memory: where `codes` is empty they come from `source`. Readers that go from top to bottom
/// take rows_of(photo), others a LoadedShot (core/rows.h); both serve either kind.
struct Photo {
  Path path;
  Exposure exposure;
  int bits = 8;        ///< codes run from 0 to 2^bits - 1; up to 8 bits they are stored in bytes
  bool lossy = false;  ///< JPEG and its kin: codes near the ends are smeared by chroma subsampling and ringing
  Codes codes;         ///< RGB interleaved, upright; a grey photograph has three equal channels; or empty
  PhotoSource source{};
  /// Of a photograph whose codes are not in memory: what was kept of them when they passed by. May be none.
  std::shared_ptr<const PhotoSamples> samples{};

  int max_code() const { return (1 << bits) - 1; }
  bool in_memory() const {
    return !std::visit([](const auto& image) { return image.empty(); }, codes);
  }
  Size size() const {
    return in_memory() ? std::visit([](const auto& image) { return image.size(); }, codes) : source.size;
  }
  int width() const { return size().width; }
  int height() const { return size().height; }
  double relative_exposure() const { return exposure.relative().value(); }
};

/// Photographs of one scene, one size and bit depth, in rising order of exposure (ties by name), whatever the order in
/// which they were named: so results do not depend on it. Made by io/bracket.h, which checks all this.
struct Bracket {
  std::vector<Photo> shots;
  std::vector<int> input_order;       ///< shots[input_order[k]] is the k-th file as the user named them
  std::vector<std::string> warnings;  ///< e.g. "no aperture in EXIF; taken as constant"

  Size size() const { return shots.empty() ? Size{} : shots.front().size(); }
  int bits() const { return shots.empty() ? 8 : shots.front().bits; }
};

}  // namespace hdr
