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
#include <half.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/core/version.h"

namespace hdr::internal {
namespace {

constexpr float kHalfMax = 65504;

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

struct Misfit {
  std::int64_t pixels = 0;
  float largest = 0;
};

/// Pixels of which a sample is beyond half's range (or not a number).
Misfit beyond_half(const Image<float>& image) {
  const auto of_rows = [&](int first, int last) {
    Misfit misfit;
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < image.width(); ++x) {
        bool fits = true;
        for (int c = 0; c < image.channels(); ++c) {
          const float v = std::abs(image(x, y, c));
          if (!(v <= kHalfMax)) fits = false;
          misfit.largest = std::max(misfit.largest, v);
        }
        if (!fits) ++misfit.pixels;
      }
    }
    return misfit;
  };
  return reduce_rows(image.height(), 16, Misfit{}, of_rows, [](Misfit& total, const Misfit& part) {
    total.pixels += part.pixels;
    total.largest = std::max(total.largest, part.largest);
  });
}

void require_half_range(const Image<float>& image, const Path& path) {
  const Misfit misfit = beyond_half(image);
  if (misfit.pixels == 0) return;
  throw Error(
      fmt::format("{}: cannot be written: {} pixels exceed the largest half, 65504 (the largest is {:g}); pass "
                  "--type float",
                  path.string(), misfit.pixels, misfit.largest));
}

Image<half> half_from_float(const Image<float>& image) {
  Image<half> halves(image.size(), image.channels());
  for_rows(image.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      std::transform(image.row(y), image.row(y) + image.row_samples(), halves.row(y), [](float v) { return half(v); });
    }
  });
  return halves;
}

Imf::Header header_of(const RadianceMap& map, const Provenance& provenance) {
  Imf::Header header(map.rgb.width(), map.rgb.height());
  const Chromaticities& xy = map.chromaticities;
  const auto v2f = [](const float(&p)[2]) { return Imath::V2f(p[0], p[1]); };
  Imf::addChromaticities(header, Imf::Chromaticities(v2f(xy.red), v2f(xy.green), v2f(xy.blue), v2f(xy.white)));
  if (map.white_luminance) Imf::addWhiteLuminance(header, static_cast<float>(*map.white_luminance));
  if (map.projection.starts_with("latlong")) Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  if (!map.projection.empty()) header.insert("hdr:projection", Imf::StringAttribute(map.projection));
  header.insert("hdr:version", Imf::StringAttribute(kVersion));
  for (const auto& [key, value] : provenance.entries) header.insert("hdr:" + key, Imf::StringAttribute(value));
  return header;
}

/// A plane of the map and the names of its channels.
struct Plane {
  const Image<float>* pixels;
  std::vector<std::string> names;
};

std::vector<Plane> planes_of(const RadianceMap& map) {
  std::vector<Plane> planes{{&map.rgb, {"R", "G", "B"}}};
  if (!map.alpha.empty()) planes.push_back({&map.alpha, {"A"}});
  if (!map.stddev.empty()) planes.push_back({&map.stddev, {"stddev.R", "stddev.G", "stddev.B"}});
  return planes;
}

template <class T>
void add_slices(const Image<T>& pixels, const std::vector<std::string>& names, Imf::PixelType type,
                Imf::FrameBuffer& frame) {
  for (std::size_t c = 0; c < names.size(); ++c) {
    // Imf::Slice is used for reading too and takes a plain char*; OutputFile only reads from it.
    char* base = const_cast<char*>(reinterpret_cast<const char*>(pixels.row(0) + c));
    frame.insert(names[c], Imf::Slice(type, base, sizeof(T) * names.size(),
                                      sizeof(T) * static_cast<std::size_t>(pixels.stride())));
  }
}

}  // namespace

void write_exr(const Path& file, const Path& path, const RadianceMap& map, const Provenance& provenance,
               const WriteOptions& options) try {
  const bool as_half = options.type == SampleType::kHalf;
  const Imf::PixelType type = as_half ? Imf::HALF : Imf::FLOAT;
  Imf::Header header = header_of(map, provenance);
  header.compression() = compression_from_name(options.compression, path);
  Imf::FrameBuffer frame;
  std::vector<Image<half>> halves;
  for (const Plane& plane : planes_of(map)) {
    HDR_ASSERT(plane.pixels->size() == map.size());
    for (const std::string& name : plane.names) header.channels().insert(name, Imf::Channel(type));
    if (as_half) {
      require_half_range(*plane.pixels, path);
      halves.push_back(half_from_float(*plane.pixels));
      add_slices(halves.back(), plane.names, type, frame);
    } else {
      add_slices(*plane.pixels, plane.names, type, frame);
    }
  }
  Imf::OutputFile out(file.c_str(), header, threads());
  out.setFrameBuffer(frame);
  out.writePixels(map.rgb.height());
} catch (const Error&) {
  throw;
} catch (const std::exception& failure) {  // OpenEXR's own
  throw Error(fmt::format("{}: cannot be written: {}; check the space on the disk", path.string(), failure.what()));
}

}  // namespace hdr::internal
