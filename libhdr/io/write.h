#pragma once
// Files out, each through OutputFile. The format follows the extension.
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "libhdr/core/photo.h"
#include "libhdr/core/radiance.h"
#include "libhdr/core/rows.h"

namespace hdr {

enum class SampleType { kHalf, kFloat };

struct WriteOptions {
  SampleType type = SampleType::kHalf;  ///< EXR only; others have their own
  /// EXR: none, rle, zip, zips, piz, pxr24, b44, b44a, dwaa, dwab. TIFF: none, zip, lzw, or with loss pixarlog (11 bits
  /// a sample: steps of 0.4 %, up to 24.2), logluv (luminance in steps of 0.27 %), logluv24 (1.1 %), logl; others are
  /// zip.
  std::string compression = "piz";
  bool grey = false;  ///< PFM: luminance alone, "Pf"
};

/// EXR (with alpha, `stddev` layer, chromaticities, whiteLuminance, hdr:* provenance, hdr:projection and OpenEXR's
/// `envmap` where it applies), HDR (with PRIMARIES where they are not Rec. 709, and lines hdr:projection and
/// hdr:whiteLuminance), PFM, TIFF in float or log. PNG/JPEG: an error that names `tonemap` (write_picture writes
/// those). Half, RGBE or Pixar's log that would overflow is an Error naming the number of pixels and what holds them.
void write_map(const Path& path, const RadianceMap& map, const Provenance& provenance = {},
               const WriteOptions& options = {});

/// All of a radiance map but its pixels, known before the first of them.
struct MapHeader {
  Size size;
  Chromaticities chromaticities{};
  std::optional<double> white_luminance{};  ///< as in RadianceMap, and the projection too
  std::string projection{};
  bool stddev = false;  ///< EXR layer `stddev`: channels stddev.R, stddev.G, stddev.B
  bool flags = false;   ///< EXR layer `mask`: channels mask.clipped and mask.dark, 0 or 1 (PixelFlag)
};

/// Takes the bands of a map and writes them as they come. Without finish() nothing is left on the disk.
class MapWriter : public MapSink {
 public:
  /// After the last row: the file is complete and in its place. Throws Error, also for a half that would overflow.
  virtual void finish() = 0;
};

/// The same bytes as write_map writes, whatever the bands, with memory for some bands of rows. Formats other than EXR
/// have no layers, and leave stddev and flags out.
std::unique_ptr<MapWriter> open_map_rows(const Path& path, const MapHeader& header, const Provenance& provenance = {},
                                         const WriteOptions& options = {});

/// 8-bit sRGB picture (PNG or JPEG); `codes` has 3 or 4 channels.
void write_picture(const Path& path, View<const std::uint8_t> codes);

/// A photograph's codes with its exposure in EXIF (ExposureTime, FNumber, ISO): JPEG (quality, 4:2:0 as cameras
/// write), PNG 8/16 or TIFF 8/16. `fov_degrees`: the lens's horizontal field, between 0 and 180, written as FocalLength
/// on a sensor 36 mm wide.
void write_photo(const Path& path, const Photo& photo, int jpeg_quality = 95, std::optional<double> fov_degrees = {});

/// A camera's own JPEG, its picture not compressed again: without padding, with Huffman tables where the stream left
/// them out, and with `exposure` in place of its EXIF. Throws Error when it is no whole JPEG.
void write_jpeg(const Path& path, std::span<const std::uint8_t> jpeg, const Exposure& exposure);

}  // namespace hdr
