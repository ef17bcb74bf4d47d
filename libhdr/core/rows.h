#pragma once
// Pictures as rows that pass by from top to bottom, so that memory follows a band of rows and not the number of shots:
// decoders are PhotoRows, writers are MapSinks, and the merge stands between them.
#include <cstdint>
#include <memory>
#include <variant>

#include "libhdr/core/image.h"
#include "libhdr/core/photo.h"

namespace hdr {

using CodesView = std::variant<View<const std::uint8_t>, View<const std::uint16_t>>;

/// The rows of one photograph: RGB codes, upright, as in Photo.
class PhotoRows {
 public:
  virtual ~PhotoRows() = default;
  virtual Size size() const = 0;
  /// Rows first .. last - 1: row k of the view is row first + k of the photograph. Neither end may fall from one call
  /// to the next. The view is valid until the next call. Throws Error where the file turns out to be damaged.
  virtual CodesView rows(int first, int last) = 0;
};

/// The rows of `photo`, which must outlive them: a view of its codes where they are in memory, else decoded again.
std::unique_ptr<PhotoRows> rows_of(const Photo& photo);

/// A photograph with its codes: a reference to `photo` (which must then outlive this) where they are in memory, else
/// decoded, and kept for the lifetime of this object alone. Throws what the decoder throws.
class LoadedShot {
 public:
  explicit LoadedShot(const Photo& photo);
  const Photo& operator*() const { return *photo_; }
  const Photo* operator->() const { return photo_; }

 private:
  std::unique_ptr<Photo> decoded_;
  const Photo* photo_;
};

/// What is known of a pixel of a radiance map besides its value.
enum PixelFlag : std::uint8_t {
  kClippedFlag = 1,  ///< a channel is clipped in every shot: its value is a lower bound
  kDarkFlag = 2,     ///< a channel is black in every shot: its value is an upper bound
};

/// A band of a radiance map: row k of each view is row first + k of the map.
struct MapRows {
  int first = 0;
  View<const float> rgb;
  View<const float> stddev;        ///< of rgb, same shape; empty when it was not asked for
  View<const std::uint8_t> flags;  ///< one channel of PixelFlag; empty when it was not asked for
};

/// Takes the bands of one map, each row once, in order.
class MapSink {
 public:
  virtual ~MapSink() = default;
  virtual void put(const MapRows& rows) = 0;
};

}  // namespace hdr
