// Luminance HDR's command, told that the photographs are sRGB.
#include <fmt/format.h>

#include <cmath>

#include "tests/bench/rivals/programs.h"

namespace hdr::bench {
namespace {

class LuminanceHdr : public MergeProgram {
 public:
  std::string name() const override { return "luminance-hdr"; }
  std::string program() const override { return "luminance-hdr-cli"; }
  std::string package() const override { return "luminance-hdr"; }

  void run(const ShotFiles& shots, const Path& output, const Path&) const override {
    std::string evs, files;
    for (std::size_t k = 0; k < shots.files.size(); ++k) {
      evs += fmt::format("{}{:.4f}", k == 0 ? "" : ",", std::log2(shots.seconds[k]));
      files += fmt::format(" {}", shell_word(shots.files[k]));
    }
    run_shell(
        fmt::format("QT_QPA_PLATFORM=offscreen luminance-hdr-cli --ev={} --hdrModel debevec --hdrResponseCurve "
                    "srgb -s {}{}",
                    evs, shell_word(output), files));
  }
};

}  // namespace

std::unique_ptr<MergeProgram> luminance_hdr() {
  return std::make_unique<LuminanceHdr>();
}

}  // namespace hdr::bench
