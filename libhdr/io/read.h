#pragma once
// Files in. A photograph is read as codes, a map as linear light; the caller says which he wants.
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/core/radiance.h"
#include "libhdr/core/rows.h"

namespace hdr {

/// 8- or 16-bit codes (JPEG, PNG, TIFF) with EXIF exposure, EXIF orientation applied (the picture is upright), alpha
/// dropped, grey repeated in three channels. A raw file is demosaiced (io/demosaic.h): its codes are linear. Throws
/// Error: missing, not an image, truncated, float samples (a radiance map is not a photograph).
Photo read_photo(const Path& path);

/// A JPEG in memory, as cameras stream them: padding after its end and missing (then standard) Huffman tables are no
/// fault. `name` is for messages. Throws Error: not a JPEG, truncated.
Photo photo_from_jpeg(std::span<const std::uint8_t> jpeg, const std::string& name);

/// The rows of a photograph (upright, as read_photo gives them), decoded as they are asked for: JPEG, PNG and TIFF with
/// a few rows in memory. A picture that is turned (EXIF orientation), tiled, interlaced, progressive, or of another
/// format is decoded whole when its first rows are asked for, one such picture at a time, into a temporary file that
/// has no name, and read back from there. `top_left`: only this part of the picture. Objects may be used side by side,
/// each by one thread at a time. Throws what read_photo throws: here for what a header tells, in rows() where the file
/// turns out to be damaged, with the row ("FILE: cannot be read after row 812 of 4000: ...").
std::unique_ptr<PhotoRows> open_photo_rows(const Path& path, std::optional<Size> top_left = std::nullopt);

/// Only the exposure and the size: no pixel is decoded.
struct PhotoHeader {
  Path path;
  Size size;
  int bits = 8;
  bool lossy = false;
  Exposure exposure;
  std::optional<double> fov_degrees{};  ///< horizontal, upright, from EXIF's focal length where it says one
  bool fov_by_sensor = false;  ///< from the size of the sensor's pixels: it holds for what was cut out of a frame, too
};
PhotoHeader read_photo_header(const Path& path);

enum class NonFinite { kReplace, kKeep };

/// How a mantissa m of a Radiance file is decoded, with exponent e: as m 2^(e-136) (OpenImageIO, OpenCV and most
/// others; right for files whose mantissas were rounded, as write_map does), or as (m + 0.5) 2^(e-136) (Radiance
/// itself, whose encoder cuts: then it is the middle of what became m). They differ by 0.2 to 0.4 % of the largest
/// channel.
enum class Mantissa { kPlain, kMiddle };

/// In which primaries a map comes: kRec709, with the same tristimulus values XYZ that the file gives (no adaptation to
/// another white: measured light stays what it is), or as they are in the file.
enum class Primaries { kRec709, kAsInFile };

struct ReadMapOptions {
  NonFinite non_finite = NonFinite::kReplace;
  Mantissa mantissa = Mantissa::kPlain;
  Primaries primaries = Primaries::kRec709;
};

/// Linear float RGB, upright: OpenEXR (of several parts the first; luminance-chroma; envmaps brought to our pixel
/// centres, cubes to a lat-long), Radiance HDR and XYZE, PFM, TIFF in float, Pixar log, LogLuv and LogL as they are;
/// raw photographs as linear camera RGB in [0,1]; integer files (PNG, JPEG, ...) decoded from sRGB to linear [0,1], and
/// a note in `warnings`. NaN and negative samples become 0 and infinities the largest finite sample of the map, counted
/// in `warnings` (a sun of any height is finite, and stays); a map without any finite sample is an Error.
/// NonFinite::kKeep leaves all samples as they are, for who wants to count them himself.
struct ReadMap {
  RadianceMap map;
  std::vector<std::string> warnings;
};
ReadMap read_map(const Path& path, const ReadMapOptions& options = {});

/// What is in a file, every pixel read (`hdr info`). Statistics are over all channels; `stops` = log2(max / smallest
/// positive sample).
struct FileInfo {
  Path path;
  std::string format, type, compression, projection;
  int width = 0, height = 0, channels = 0;
  Exposure exposure;
  std::optional<double> white_luminance;  ///< cd/m^2 of (1,1,1)
  double min = 0, max = 0, mean = 0, stops = 0;
  std::int64_t nan = 0, inf = 0, negative = 0;
};
FileInfo read_info(const Path& path);

/// Extensions that SHOTS in a folder may have (lower case, with the dot): photographs, never radiance maps.
bool is_photo_name(const Path& path);

}  // namespace hdr
