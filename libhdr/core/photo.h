#pragma once
// A photograph as the camera wrote it: integer codes through an unknown response. The type is the colour tag: codes
// live in a Photo, linear radiance in a RadianceMap (core/radiance.h), and only response/ and merge/ turn one into the
// other.
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "libhdr/core/exposure.h"
#include "libhdr/core/image.h"

namespace hdr {

using Path = std::filesystem::path;
using Codes = std::variant<Image<std::uint8_t>, Image<std::uint16_t>>;

struct Photo {
  Path path;
  Exposure exposure;
  int bits = 8;        ///< codes run from 0 to 2^bits - 1; up to 8 bits they are stored in bytes
  bool lossy = false;  ///< JPEG and its kin: codes near the ends are smeared by chroma subsampling and ringing
  Codes codes;         ///< RGB interleaved, upright; a grey photograph has three equal channels

  int max_code() const { return (1 << bits) - 1; }
  int width() const {
    return std::visit([](const auto& image) { return image.width(); }, codes);
  }
  int height() const {
    return std::visit([](const auto& image) { return image.height(); }, codes);
  }
  Size size() const { return {width(), height()}; }
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
