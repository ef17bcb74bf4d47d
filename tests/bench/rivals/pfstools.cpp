// pfstools: pfsinhdrgen | pfshdrcalibrate | pfsoutexr.
#include <fmt/format.h>

#include "libhdr/io/output_file.h"
#include "tests/bench/rivals/programs.h"

namespace hdr::bench {
namespace {

class PfsTools : public MergeProgram {
 public:
  std::string name() const override { return "pfshdrcalibrate"; }
  std::string program() const override { return "pfshdrcalibrate"; }
  std::string package() const override { return "pfstools"; }

  void run(const ShotFiles& shots, const Path& output, const Path& scratch) const override {
    std::string list;  // its lines are: path 1/seconds aperture iso 0
    for (std::size_t k = 0; k < shots.files.size(); ++k) {
      list += fmt::format("{} {:.9g} 1 100 0\n", shots.files[k].string(), 1 / shots.seconds[k]);
    }
    const Path script = scratch / "shots.hdrgen";
    write_text(script, list);
    run_shell(fmt::format("pfsinhdrgen {} | pfshdrcalibrate --calibration robertson | pfsoutexr {}", shell_word(script),
                          shell_word(output)));
  }
};

}  // namespace

std::unique_ptr<MergeProgram> pfstools() {
  return std::make_unique<PfsTools>();
}

}  // namespace hdr::bench
