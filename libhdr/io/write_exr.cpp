#include "libhdr/io/internal/write_exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfEnvmapAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/version.h"
#include "libhdr/io/internal/half_rows.h"

namespace hdr::internal {
namespace {

Imf::Compression compression_from_name(const std::string& name, const Path& path) {
  static const std::array<std::pair<const char*, Imf::Compression>, 10> kNames = {{{"none", Imf::NO_COMPRESSION},
                                                                                   {"rle", Imf::RLE_COMPRESSION},
                                                                                   {"zips", Imf::ZIPS_COMPRESSION},
                                                                                   {"zip", Imf::ZIP_COMPRESSION},
                                                                                   {"piz", Imf::PIZ_COMPRESSION},
                                                                                   {"pxr24", Imf::PXR24_COMPRESSION},
                                                                                   {"b44", Imf::B44_COMPRESSION},
                                                                                   {"b44a", Imf::B44A_COMPRESSION},
                                                                                   {"dwaa", Imf::DWAA_COMPRESSION},
                                                                                   {"dwab", Imf::DWAB_COMPRESSION}}};
  std::string known;
  for (const auto& [each, value] : kNames) {
    if (name == each) return value;
    known += (known.empty() ? "" : ", ") + std::string(each);
  }
  throw Error(fmt::format("{}: no EXR compression called '{}'; one of {}", path.string(), name, known));
}

Imf::Header header_of(const MapHeader& map, const Provenance& provenance) {
  Imf::Header header(map.size.width, map.size.height);
  const Chromaticities& xy = map.chromaticities;
  const auto v2f = [](const float(&p)[2]) { return Imath::V2f(p[0], p[1]); };
  Imf::addChromaticities(header, Imf::Chromaticities(v2f(xy.red), v2f(xy.green), v2f(xy.blue), v2f(xy.white)));
  if (map.white_luminance) Imf::addWhiteLuminance(header, static_cast<float>(*map.white_luminance));
  if (map.projection == "latlong") Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  if (map.projection == "cube-strip" && map.size.height == 6 * map.size.width) {
    Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  }
  if (!map.projection.empty()) header.insert("hdr:projection", Imf::StringAttribute(map.projection));
  header.insert("hdr:version", Imf::StringAttribute(kVersion));
  for (const auto& [key, value] : provenance.entries) header.insert("hdr:" + key, Imf::StringAttribute(value));
  return header;
}

/// OpenEXR compresses blocks of lines, each as a task of its own: enough of them at a time for all threads.
int rows_at_a_time(Imf::Compression compression, int height) {
  const int block = compression == Imf::DWAB_COMPRESSION ? 256 : 32;
  return std::min(height, block * 2 * threads());
}

/// Channels of one layer, interleaved: rows that wait to be compressed, as the file's type of sample.
struct Plane {
  std::vector<std::string> names;
  bool as_half = true;
  Image<std::uint16_t> halves;
  Image<float> floats;

  int channels() const { return static_cast<int>(names.size()); }
};

template <class T>
void add_slices(Image<T>& rows, const Plane& plane, Imf::PixelType type, int first, Imf::FrameBuffer& frame) {
  const auto step = static_cast<std::ptrdiff_t>(sizeof(T)) * rows.stride();
  for (int c = 0; c < plane.channels(); ++c) {
    // A Slice's base is where row 0 of the file would be.
    char* base = reinterpret_cast<char*>(rows.row(0) + c) - first * step;
    frame.insert(plane.names[static_cast<std::size_t>(c)],
                 Imf::Slice(type, base, sizeof(T) * plane.names.size(), static_cast<std::size_t>(step)));
  }
}

}  // namespace

class ExrWriter::File {
 public:
  File(const Path& file, const Path& path, const MapHeader& map, bool alpha, const Provenance& provenance,
       const WriteOptions& options, const std::vector<std::vector<std::string>>& more)
      : path_(path), as_half_(options.type == SampleType::kHalf), size_(map.size), planes_(kPlanes + more.size()) {
    Imf::Header header = header_of(map, provenance);
    header.compression() = compression_from_name(options.compression, path);
    add_plane(header, kRgb, {"R", "G", "B"});
    if (alpha) add_plane(header, kAlpha, {"A"});
    if (map.stddev) add_plane(header, kStddev, {"stddev.R", "stddev.G", "stddev.B"});
    if (map.flags) add_plane(header, kFlags, {"mask.clipped", "mask.dark"});
    for (std::size_t k = 0; k < more.size(); ++k) add_plane(header, kPlanes + k, more[k], false);
    if (Imf::globalThreadCount() != threads()) Imf::setGlobalThreadCount(threads());
    out_ = std::make_unique<Imf::OutputFile>(file.c_str(), header, threads());
  }

  void put(const ExrBand& band) {
    const int rows = band.rgb.height();
    HDR_ASSERT(band.rgb.width() == size_.width && first_ + waiting_ + rows <= size_.height);
    const int room = planes_[kRgb].halves.height() + planes_[kRgb].floats.height();
    for (int taken = 0; taken < rows;) {
      const int count = std::min(rows - taken, room - waiting_);
      take(kRgb, band.rgb, taken, count);
      take(kAlpha, band.alpha, taken, count);
      take(kStddev, band.stddev, taken, count);
      take(kFlags, band.flags, taken, count);
      for (std::size_t k = kPlanes; k < planes_.size(); ++k) take(k, band.more.at(k - kPlanes), taken, count);
      taken += count;
      waiting_ += count;
      if (waiting_ == room) flush();
    }
  }

  void finish() {
    flush();
    HDR_ASSERT(first_ == size_.height);
    if (misfit_.pixels > 0) {
      throw Error(
          fmt::format("{}: cannot be written: {} pixels exceed the largest half, 65504 (the largest is {:g}); pass "
                      "--type float",
                      path_.string(), misfit_.pixels, misfit_.largest));
    }
    out_.reset();
  }

 private:
  enum PlaneIndex : std::size_t { kRgb, kAlpha, kStddev, kFlags, kPlanes };

  void add_plane(Imf::Header& header, std::size_t index, std::vector<std::string> names) {
    add_plane(header, index, std::move(names), as_half_);
  }
  void add_plane(Imf::Header& header, std::size_t index, std::vector<std::string> names, bool as_half) {
    Plane& plane = planes_[index];
    plane.names = std::move(names);
    plane.as_half = as_half;
    const int rows = rows_at_a_time(header.compression(), size_.height);
    if (as_half) {
      plane.halves = Image<std::uint16_t>(size_.width, rows, plane.channels());
    } else {
      plane.floats = Image<float>(size_.width, rows, plane.channels());
    }
    for (const std::string& name : plane.names) header.channels().insert(name, Imf::Channel(type_of(plane)));
  }
  static Imf::PixelType type_of(const Plane& plane) { return plane.as_half ? Imf::HALF : Imf::FLOAT; }

  /// Rows taken .. taken + count - 1 of the band, behind those that wait already.
  template <class T>
  void take(std::size_t index, const View<const T>& band, int taken, int count) {
    Plane& plane = planes_[index];
    if (plane.names.empty()) return;
    HDR_ASSERT(band.width() == size_.width && band.height() >= taken + count);
    const auto misfit = reduce_rows(
        count, 8, Misfit{},
        [&](int first, int last) {
          Misfit part;
          std::vector<float> spread;
          for (int y = first; y < last; ++y) {
            const float* row = floats_of(band.row(taken + y), plane, spread);
            add(part, place(row, plane, waiting_ + y));
          }
          return part;
        },
        add);
    add(misfit_, misfit);
  }

  static void add(Misfit& total, const Misfit& part) {
    total.pixels += part.pixels;
    total.largest = std::max(total.largest, part.largest);
  }

  static const float* floats_of(const float* row, const Plane&, std::vector<float>&) { return row; }
  /// Flags become a channel each, 0 or 1.
  const float* floats_of(const std::uint8_t* flags, const Plane& plane, std::vector<float>& spread) const {
    spread.resize(static_cast<std::size_t>(size_.width) * plane.names.size());
    for (std::size_t x = 0; x < static_cast<std::size_t>(size_.width); ++x) {
      spread[2 * x] = flags[x] & kClippedFlag ? 1 : 0;
      spread[2 * x + 1] = flags[x] & kDarkFlag ? 1 : 0;
    }
    return spread.data();
  }

  Misfit place(const float* row, Plane& plane, int at) const {
    const std::size_t samples = static_cast<std::size_t>(size_.width) * plane.names.size();
    if (!plane.as_half) {
      std::copy_n(row, samples, plane.floats.row(at));
      return {};
    }
    halves_from_floats(row, plane.halves.row(at), samples);
    return beyond_half(row, size_.width, plane.channels());
  }

  void flush() {
    if (waiting_ == 0) return;
    Imf::FrameBuffer frame;
    for (Plane& plane : planes_) {
      if (plane.names.empty()) continue;
      if (plane.as_half) {
        add_slices(plane.halves, plane, type_of(plane), first_, frame);
      } else {
        add_slices(plane.floats, plane, type_of(plane), first_, frame);
      }
    }
    out_->setFrameBuffer(frame);
    out_->writePixels(waiting_);
    first_ += waiting_;
    waiting_ = 0;
  }

  Path path_;
  bool as_half_;
  Size size_;
  std::vector<Plane> planes_;
  int first_ = 0, waiting_ = 0;  ///< rows written, and rows in the planes
  Misfit misfit_;
  std::unique_ptr<Imf::OutputFile> out_;
};

namespace {

/// Errors of OpenEXR say what to do about them.
template <class Work>
auto translated(const Path& path, const Work& work) try {
  return work();
} catch (const Error&) {
  throw;
} catch (const std::exception& failure) {
  throw Error(fmt::format("{}: cannot be written: {}; check the space on the disk", path.string(), failure.what()));
}

}  // namespace

ExrWriter::ExrWriter(const Path& file, const Path& path, const MapHeader& header, bool alpha,
                     const Provenance& provenance, const WriteOptions& options,
                     const std::vector<std::vector<std::string>>& more)
    : path_(path), file_(translated(path, [&] {
        return std::make_unique<File>(file, path, header, alpha, provenance, options, more);
      })) {}

ExrWriter::~ExrWriter() = default;

void ExrWriter::put(const ExrBand& band) {
  translated(path_, [&] { file_->put(band); });
}

void ExrWriter::finish() {
  translated(path_, [&] { file_->finish(); });
}

}  // namespace hdr::internal
