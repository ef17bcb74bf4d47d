#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <fmt/format.h>

#include "libhdr/core/error.h"
#include "libhdr/core/parallel.h"
#include "libhdr/io/internal/own_inputs.h"
#include "libhdr/io/internal/rec709.h"

namespace hdr::internal {
namespace {

/// OpenEXR itself makes RGB of luminance and chroma (ImfRgbaFile), in half.
class ChromaExrInput final : public FloatRowsInput {
 public:
  ChromaExrInput(const Path& path, std::unique_ptr<Imf::RgbaInputFile> file)
      : name_(path.string()), file_(std::move(file)) {
    const Imath::Box2i data = file_->dataWindow(), display = file_->displayWindow();
    const auto side = [](int low, int high) { return static_cast<int>(static_cast<std::int64_t>(high) - low + 1); };
    alpha_ = (file_->channels() & Imf::WRITE_A) != 0;
    m_spec = OIIO::ImageSpec(side(data.min.x, data.max.x), side(data.min.y, data.max.y), alpha_ ? 4 : 3,
                             OIIO::TypeDesc::FLOAT);
    m_spec.x = data.min.x;
    m_spec.y = data.min.y;
    m_spec.full_x = display.min.x;
    m_spec.full_y = display.min.y;
    m_spec.full_width = side(display.min.x, display.max.x);
    m_spec.full_height = side(display.min.y, display.max.y);
    m_spec.attribute("compression", "luminance-chroma");
    if (Imf::hasChromaticities(file_->header())) {
      const Imf::Chromaticities& xy = Imf::chromaticities(file_->header());
      set_chromaticities(
          m_spec, {{xy.red.x, xy.red.y}, {xy.green.x, xy.green.y}, {xy.blue.x, xy.blue.y}, {xy.white.x, xy.white.y}});
    }
    if (Imf::hasWhiteLuminance(file_->header())) {
      m_spec.attribute("whiteLuminance", Imf::whiteLuminance(file_->header()));
    }
    row_.resize(static_cast<std::size_t>(m_spec.width));
  }
  const char* format_name() const override { return "openexr"; }

 private:
  void decode(int y, float* samples) override {
    const int line = m_spec.y + y;
    try {
      // A frame buffer's base is where pixel (0,0) of the file would be.
      file_->setFrameBuffer(row_.data() - m_spec.x, 1, 0);
      file_->readPixels(line);
    } catch (const std::exception& failure) {
      throw Error(fmt::format("{}: cannot be read after row {} of {}: {}; is it damaged?", name_, y, m_spec.height,
                              failure.what()));
    }
    for (const Imf::Rgba& pixel : row_) {
      *samples++ = pixel.r;
      *samples++ = pixel.g;
      *samples++ = pixel.b;
      if (alpha_) *samples++ = pixel.a;
    }
  }

  std::string name_;
  std::unique_ptr<Imf::RgbaInputFile> file_;
  bool alpha_ = false;
  std::vector<Imf::Rgba> row_;
};

}  // namespace

std::shared_ptr<OIIO::ImageInput> open_chroma_exr(const Path& path) {
  try {
    auto file = std::make_unique<Imf::RgbaInputFile>(path.c_str(), threads());
    const Imf::ChannelList& channels = file->header().channels();
    if (!channels.findChannel("RY") && !channels.findChannel("BY")) return nullptr;
    return std::make_shared<ChromaExrInput>(path, std::move(file));
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    return nullptr;  // OpenImageIO says why
  }
}

}  // namespace hdr::internal
