#pragma once
// Formats that OpenImageIO 2.4 does not read, or not exactly, behind its own interface: 32-bit float samples as stored,
// not yet upright. All throw Error from here for what a header tells, and from read_native_scanline where the file
// turns out to be damaged, with the row.
#include <OpenImageIO/imageio.h>

#include <memory>
#include <optional>

#include "libhdr/core/photo.h"
#include "libhdr/io/read.h"

namespace hdr::internal {

/// Rows that are decoded by us.
class FloatRowsInput : public OIIO::ImageInput {
 public:
  bool open(const std::string&, OIIO::ImageSpec& spec) override {
    spec = m_spec;
    return true;
  }
  bool close() override { return true; }
  bool read_native_scanline(int, int, int y, int, void* data) override {
    decode(y - m_spec.y, static_cast<float*>(data));
    return true;
  }

 protected:
  /// Row y from the top of what is stored.
  virtual void decode(int y, float* samples) = 0;
};

/// Radiance pictures. OpenImageIO knows neither XYZE, EXPOSURE nor most orientations.
std::shared_ptr<OIIO::ImageInput> open_radiance(const Path& path, Mantissa mantissa);

std::shared_ptr<OIIO::ImageInput> open_pfm(const Path& path);

/// TIFF compressed as Pixar's log, LogLuv or LogL [Larson98], which OpenImageIO reads as 8 bits; nullptr for others.
std::shared_ptr<OIIO::ImageInput> open_log_tiff(const Path& path);

/// OpenEXR with luminance and chroma at half the resolution (channels Y, RY, BY); nullptr for others.
std::shared_ptr<OIIO::ImageInput> open_chroma_exr(const Path& path);

}  // namespace hdr::internal
