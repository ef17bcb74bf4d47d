#include "libhdr/io/internal/oiio.h"

#include <OpenImageIO/filesystem.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/internal/dng_file.h"
#include "libhdr/io/internal/file_kind.h"
#include "libhdr/io/internal/jpeg_file.h"
#include "libhdr/io/internal/jpeg_markers.h"
#include "libhdr/io/internal/own_inputs.h"
#include "libhdr/io/internal/patched_file.h"

namespace hdr::internal {
namespace {

namespace fs = std::filesystem;

void check_file(const Path& path) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status)) throw Error(path.string() + ": no such file; check the name");
  if (fs::is_directory(status)) throw Error(path.string() + ": is a folder; name a picture in it");
  if (fs::is_regular_file(status) && fs::file_size(path, failed) == 0) {
    throw Error(path.string() + ": is empty (0 bytes); copy it again from where it came");
  }
}

void check_size(const Path& path, const OIIO::ImageSpec& spec, FileKind kind) {
  if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) {
    throw Error(path.string() + ": has no pixels; is it damaged?");
  }
  std::error_code failed;
  const auto bytes = static_cast<double>(fs::file_size(path, failed));
  const double pixels = 1.0 * spec.width * spec.height;
  if (!failed && pixels > bytes * most_pixels_per_byte(kind)) {
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

/// OpenImageIO and OpenEXR keep pools of their own: they get as many threads as we have. OpenImageIO 2.4 resizes its
/// pool at every call, and aborts when another thread asks meanwhile how large it is: files are opened from many
/// threads.
void share_threads() {
  static std::mutex guard;
  static int shared = 0;
  const std::lock_guard lock(guard);
  if (shared == threads()) return;
  shared = threads();
  OIIO::attribute("threads", shared);
  OIIO::attribute("exr_threads", shared);
}

/// Memory that this machine has, in bytes.
double memory_here() {
  return 1.0 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// What reads the file besides OpenImageIO; nullptr: it does.
std::shared_ptr<OIIO::ImageInput> open_by_ourselves(const Path& path, FileKind kind, Mantissa mantissa) {
  switch (kind) {
    case FileKind::kRaw:
      return open_raw(path);
    case FileKind::kRadiance:
      return open_radiance(path, mantissa);
    case FileKind::kPfm:
      return open_pfm(path);
    case FileKind::kTiff:
      return open_log_tiff(path);
    default:
      return nullptr;
  }
}

/// Where an input that failed as a whole fails: its rows once more, one after the other. nullopt: in no row, or tiles.
std::optional<int> first_bad_row(OIIO::ImageInput& input) {
  const OIIO::ImageSpec& spec = input.spec();
  if (spec.tile_width > 0) return std::nullopt;
  std::vector<float> row(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels));
  for (int y = 0; y < spec.height; ++y) {
    if (!input.read_scanline(spec.y + y, 0, OIIO::TypeDesc::FLOAT, row.data()) || input.has_error()) return y;
  }
  return std::nullopt;
}

}  // namespace

void require_memory(const Path& path, int width, int height, double bytes_a_pixel) {
  const double bytes = bytes_a_pixel * width * height;
  if (bytes <= memory_here()) return;
  throw Error(fmt::format("{}: {} x {} pixels need {:.1f} GB, and this machine has {:.1f}; scale it down",
                          path.string(), width, height, bytes / 1e9, memory_here() / 1e9));
}

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

OpenedPicture open_picture_for_rows(const Path& path, Mantissa mantissa) {
  /// The file that a picture is read from lives as long as the input.
  struct Opened {
    std::unique_ptr<OIIO::Filesystem::IOProxy> file;
    std::unique_ptr<OIIO::ImageInput> input;
  };
  check_file(path);
  share_threads();
  const FileKind kind = kind_of_file(path);
  if (const auto own = open_by_ourselves(path, kind, mantissa)) {
    check_size(path, own->spec(), kind);
    return {own, false};
  }
  const char* reader = oiio_reader_of(kind);
  if (!reader) {
    throw Error(path.string() +
                ": not a picture that can be read: it does not begin as EXR, Radiance HDR, PFM, TIFF, PNG, JPEG, WebP, "
                "HEIF, BMP or PNM; is it a photograph or a map?");
  }
  const auto opened = std::make_shared<Opened>();
  const std::optional<JpegLayout> jpeg = vet_jpeg(path);
  if (jpeg) opened->file = jpeg_without_profiles(path, jpeg->profiles);
  if (kind == FileKind::kTiff) opened->file = patched_file(path, patches_of_tiff(path));
  if (kind == FileKind::kPng) opened->file = patched_file(path, patches_of_png(path));
  OIIO::ImageSpec config, spec;
  config.attribute("oiio:UnassociatedAlpha", 1);
  bool open = false;
  std::string reason;
  {
    // One header at a time: reading camera headers side by side, OpenImageIO 2.4 crashed once in twenty brackets.
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    opened->input = OIIO::ImageInput::create(reader);  // this reader alone, whatever the file is called
    if (opened->input) {
      if (opened->file) opened->input->set_ioproxy(opened->file.get());
      open = opened->input->open(path.string(), spec, config);
      if (!open) reason = opened->input->geterror();
    } else {
      reason = OIIO::geterror();
    }
  }
  // OpenImageIO refuses subsampled channels, and knows no luminance-chroma of any kind.
  if (kind == FileKind::kExr && (!open || spec.channelindex("RY") >= 0)) {
    if (const auto chroma = open_chroma_exr(path)) {
      check_size(path, chroma->spec(), kind);
      return {chroma, false};
    }
  }
  if (!open) {
    throw Error(fmt::format("{}: not a picture that can be read: {}; is it a photograph or a map?", path.string(),
                            oiio_message(reason, path)));
  }
  check_size(path, opened->input->spec(), kind);
  return {{opened, opened->input.get()}, jpeg ? jpeg->scans == 1 : decodes_in_one_pass(*opened->input, path)};
}

std::shared_ptr<OIIO::ImageInput> open_picture(const Path& path, Mantissa mantissa) {
  return open_picture_for_rows(path, mantissa).input;
}

Image<float> read_floats(OIIO::ImageInput& input, const Path& path) {
  const OIIO::ImageSpec& spec = input.spec();
  require_memory(path, spec.width, spec.height, sizeof(float) * static_cast<double>(spec.nchannels));
  Image<float> image(spec.width, spec.height, spec.nchannels);
  const auto step = static_cast<OIIO::stride_t>(sizeof(float));
  const bool read = input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.row(0),
                                     step * spec.nchannels, step * image.stride());
  if (read && !input.has_error()) return image;  // a truncated TIFF is "read", with an error left
  const std::string reason = input.geterror();
  const std::optional<int> row = first_bad_row(input);
  if (!row || !input.has_error()) {
    throw Error(fmt::format("{}: cannot be read: {}; is it damaged?", path.string(), oiio_message(reason, path)));
  }
  throw_unreadable(path, input, row);
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
