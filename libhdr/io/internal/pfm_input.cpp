#include "libhdr/io/internal/own_inputs.h"
#include "libhdr/io/internal/pfm_file.h"
#include "libhdr/io/output_file.h"

namespace hdr::internal {
namespace {

class PfmInput final : public FloatRowsInput {
 public:
  explicit PfmInput(const Path& path) : bytes_(read_text(path)), header_(parse_pfm_header(bytes_, path.string())) {
    m_spec = OIIO::ImageSpec(header_.width, header_.height, header_.channels, OIIO::TypeDesc::FLOAT);
    if (header_.channels == 1) m_spec.channelnames = {"Y"};
  }
  const char* format_name() const override { return "pfm"; }

 private:
  void decode(int y, float* samples) override { decode_pfm_row(bytes_, header_, y, samples); }

  std::string bytes_;
  PfmHeader header_;
};

}  // namespace

std::shared_ptr<OIIO::ImageInput> open_pfm(const Path& path) {
  return std::make_shared<PfmInput>(path);
}

}  // namespace hdr::internal
