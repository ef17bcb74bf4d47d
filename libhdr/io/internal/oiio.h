#pragma once
// OpenImageIO's files, opened with errors that name the file and say what stands in the way.
#include <OpenImageIO/imageio.h>

#include <memory>
#include <optional>
#include <string>

#include "libhdr/core/image.h"
#include "libhdr/core/photo.h"
#include "libhdr/io/read.h"

namespace hdr::internal {

/// Opens a picture, by what its first bytes say it is (file_kind.h). Throws Error: missing, a folder, empty, not a
/// picture, a JPEG, PNG or TIFF that ends early, a header that promises more pixels than such a file can hold. Samples
/// come as stored: alpha is not multiplied in. `mantissa` is for Radiance files.
std::shared_ptr<OIIO::ImageInput> open_picture(const Path& path, Mantissa mantissa = Mantissa::kPlain);

/// The same; and whether scanlines are decoded as they are asked for, with memory for a few of them: not so in tiled
/// and interlaced files, in progressive JPEGs, and in formats that OpenImageIO decodes whole.
struct OpenedPicture {
  std::shared_ptr<OIIO::ImageInput> input;
  bool in_one_pass = false;
};
OpenedPicture open_picture_for_rows(const Path& path, Mantissa mantissa = Mantissa::kPlain);

/// Throws Error when a picture of this size is more than this machine's memory: before anything is allocated.
void require_memory(const Path& path, int width, int height, double bytes_a_pixel);

/// Lower case, with the dot.
std::string extension_of(const Path& path);

/// "FILE: cannot be written: MESSAGE; check the name and the space on the disk"
[[noreturn]] void throw_unwritable(const Path& path, const std::string& message);

/// What OpenImageIO says went wrong, its first line, without the file's name in front.
std::string oiio_message(const std::string& raw, const Path& path);

/// "FILE: cannot be read: MESSAGE; is it damaged?", or with a row "FILE: cannot be read after row 12 of 480: ..."
[[noreturn]] void throw_unreadable(const Path& path, OIIO::ImageInput& input, std::optional<int> row = std::nullopt);

/// Decodes all channels as float (integer samples as fractions of the full scale) straight into our rows. Throws Error
/// that names the row, where the file has rows.
Image<float> read_floats(OIIO::ImageInput& input, const Path& path);

/// Whether the format or the compression loses detail (JPEG and its kin).
bool is_lossy(const OIIO::ImageInput& input);

/// EXIF orientation 1 to 8; anything else counts as 1.
int orientation_of(const OIIO::ImageSpec& spec);

/// Size of the picture when upright: orientations 5 to 8 lie on their side.
Size upright_size(const OIIO::ImageSpec& spec);

}  // namespace hdr::internal
