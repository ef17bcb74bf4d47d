#include "libhdr/io/internal/oiio.h"

#include <OpenImageIO/filesystem.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <mutex>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/internal/dng_file.h"
#include "libhdr/io/internal/jpeg_file.h"
#include "libhdr/io/internal/jpeg_markers.h"

namespace hdr::internal {
namespace {

namespace fs = std::filesystem;

/// No codec packs more: deflate 1032 samples a byte, run lengths far fewer. A header that promises more is damaged, and
/// would ask for memory that the picture does not need.
constexpr double kMostPixelsPerByte = 65536;

void check_file(const Path& path) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status)) throw Error(path.string() + ": no such file; check the name");
  if (fs::is_directory(status)) throw Error(path.string() + ": is a folder; name a picture in it");
  if (fs::is_regular_file(status) && fs::file_size(path, failed) == 0) {
    throw Error(path.string() + ": is empty (0 bytes); copy it again from where it came");
  }
}

void check_size(const Path& path, const OIIO::ImageSpec& spec) {
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) {
    throw Error(path.string() + ": has no pixels; is it damaged?");
  }
  std::error_code failed;
  const auto bytes = static_cast<double>(fs::file_size(path, failed));
  const double pixels = 1.0 * spec.width * spec.height;
  if (!failed && pixels > bytes * kMostPixelsPerByte) {
    throw Error(fmt::format("{}: its header promises {} x {} pixels in {} bytes; is it damaged?", path.string(),
                            spec.width, spec.height, bytes));
  }
}

bool is_interlaced_png(const Path& path) {
  constexpr std::size_t kInterlaceMethod = 28;  // in IHDR, always the first chunk (PNG, 11.2.2)
  char start[kInterlaceMethod + 1] = {};
  std::ifstream(path, std::ios::binary).read(start, sizeof start);
  return start[kInterlaceMethod] != 0;
}

bool decodes_in_one_pass(const OIIO::ImageInput& input, const Path& path) {
  const std::string format = input.format_name();
  if (format == "png") return !is_interlaced_png(path);
  return format == "tiff" && input.spec().tile_width == 0;
}

/// OpenImageIO and OpenEXR keep pools of their own: they get as many threads as we have.
void share_threads() {
  OIIO::attribute("threads", threads());
  OIIO::attribute("exr_threads", threads());
}

}  // namespace

std::string extension_of(const Path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void throw_unwritable(const Path& path, const std::string& message) {
  throw Error(fmt::format("{}: cannot be written: {}; check the name and the space on the disk", path.string(),
                          oiio_message(message, path)));
}

std::string oiio_message(const std::string& raw, const Path& path) {
  std::string text = raw.empty() ? "unknown error" : raw;
  for (const std::string& name : {fmt::format("\"{}\": ", path.string()), fmt::format(" \"{}\"", path.string()),
                                  fmt::format("{}: ", path.string())}) {
    if (const auto at = text.find(name); at != std::string::npos) text.erase(at, name.size());
  }
  text.erase(std::min(text.size(), text.find('\n')));
  return text;
}

void throw_unreadable(const Path& path, OIIO::ImageInput& input, std::optional<int> row) {
  const std::string where = row ? fmt::format(" after row {} of {}", *row, input.spec().height) : "";
  throw Error(fmt::format("{}: cannot be read{}: {}; is it damaged?", path.string(), where,
                          oiio_message(input.geterror(), path)));
}

OpenedPicture open_picture_for_rows(const Path& path) {
  /// The file that a JPEG is read from lives as long as the input.
  struct Opened {
    std::unique_ptr<OIIO::Filesystem::IOProxy> file;
    std::unique_ptr<OIIO::ImageInput> input;
  };
  check_file(path);
  share_threads();
  if (is_dng_name(path)) {
    const auto dng = open_dng(path);
    check_size(path, dng->spec());
    return {dng, false};
  }
  const auto opened = std::make_shared<Opened>();
  const std::optional<JpegLayout> jpeg = vet_jpeg(path);
  if (jpeg) opened->file = jpeg_without_profiles(path, jpeg->profiles);
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  {
    // One header at a time: reading camera headers side by side, OpenImageIO 2.4 crashed once in twenty brackets.
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    opened->input = OIIO::ImageInput::open(path.string(), &config, opened->file.get());
  }
  if (!opened->input) {
    throw Error(fmt::format("{}: not a picture that can be read: {}; is it a photograph or a map?", path.string(),
                            oiio_message(OIIO::geterror(), path)));
  }
  check_size(path, opened->input->spec());
  return {{opened, opened->input.get()}, jpeg ? jpeg->scans == 1 : decodes_in_one_pass(*opened->input, path)};
}

std::shared_ptr<OIIO::ImageInput> open_picture(const Path& path) {
  return open_picture_for_rows(path).input;
}

Image<float> read_floats(OIIO::ImageInput& input, const Path& path) {
  const OIIO::ImageSpec& spec = input.spec();
  Image<float> image(spec.width, spec.height, spec.nchannels);
  const auto step = static_cast<OIIO::stride_t>(sizeof(float));
  const bool read = input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.row(0),
                                     step * spec.nchannels, step * image.stride());
  if (!read || input.has_error()) throw_unreadable(path, input);  // a truncated TIFF is "read", with an error left
  return image;
}

bool is_lossy(const OIIO::ImageInput& input) {
  const std::string format = input.format_name();
  return format == "jpeg" || format == "webp" || format == "heif" ||
         input.spec().get_string_attribute("compression") == "jpeg";
}

int orientation_of(const OIIO::ImageSpec& spec) {
  const int orientation = spec.get_int_attribute("Orientation", 1);
  return orientation >= 1 && orientation <= 8 ? orientation : 1;
}

Size upright_size(const OIIO::ImageSpec& spec) {
  return orientation_of(spec) >= 5 ? Size{spec.height, spec.width} : Size{spec.width, spec.height};
}

}  // namespace hdr::internal
