#pragma once
// Another program's way from a bracket to a map, to be measured against.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/response.h"

namespace hdr::bench {

struct RivalAnswer {
  std::shared_ptr<const void> owner;  ///< of the pixels
  View<const float> map;              ///< relative radiance, 3 channels, each up to a factor
  Response response;
};

class Rival {
 public:
  virtual ~Rival() = default;
  virtual std::string name() const = 0;
  /// Calibrates and merges registered shots of 8 bits, nothing else: this is what is timed.
  virtual RivalAnswer run(const Bracket& bracket, int threads) const = 0;
};

/// The same for registration.
class AlignRival {
 public:
  virtual ~AlignRival() = default;
  virtual std::string name() const = 0;
  /// ref_from_photo of each shot (pixel centres at integers), the middle shot the reference: this is what is timed.
  virtual std::vector<Mat3> run(const Bracket& bracket, int threads) const = 0;
};

std::vector<std::unique_ptr<AlignRival>> available_align_rivals();

/// Those whose libraries were there when this was built.
std::vector<std::unique_ptr<Rival>> available_rivals();

}  // namespace hdr::bench
