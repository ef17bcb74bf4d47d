#include "libhdr/io/internal/own_inputs.h"
#include "libhdr/io/internal/radiance_file.h"
#include "libhdr/io/internal/rec709.h"
#include "libhdr/io/output_file.h"

namespace hdr::internal {
namespace {

class RadianceInput final : public FloatRowsInput {
 public:
  RadianceInput(const Path& path, Mantissa mantissa)
      : name_(path.string()),
        bytes_(read_text(path)),
        header_(parse_radiance_header(bytes_, name_)),
        mantissa_(mantissa),
        scanlines_(bytes_, header_, mantissa, name_) {
    m_spec = OIIO::ImageSpec(header_.length, header_.scanlines, 3, OIIO::TypeDesc::FLOAT);
    m_spec.attribute("Orientation", header_.orientation);
    if (header_.xyz) {
      set_chromaticities(m_spec, kXyz);
    } else if (header_.primaries) {
      set_chromaticities(m_spec, *header_.primaries);
    }
    if (header_.white_luminance) m_spec.attribute("whiteLuminance", static_cast<float>(*header_.white_luminance));
    if (!header_.projection.empty()) m_spec.attribute("hdr:projection", header_.projection);
  }
  const char* format_name() const override { return "hdr"; }

 private:
  void decode(int y, float* samples) override {
    if (y < scanlines_.done()) scanlines_ = RadianceScanlines(bytes_, header_, mantissa_, name_);
    while (scanlines_.done() <= y) scanlines_.next(samples);
  }

  std::string name_, bytes_;
  RadianceHeader header_;
  Mantissa mantissa_;
  RadianceScanlines scanlines_;
};

}  // namespace

std::shared_ptr<OIIO::ImageInput> open_radiance(const Path& path, Mantissa mantissa) {
  return std::make_shared<RadianceInput>(path, mantissa);
}

}  // namespace hdr::internal
