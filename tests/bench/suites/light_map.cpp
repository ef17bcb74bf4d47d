#include "tests/bench/suites/light_map.h"

#include "libhdr/core/error.h"
#include "libhdr/filter/resize.h"
#include "libhdr/io/read.h"
#include "tests/bench/light_truth.h"

namespace hdr::bench {

Image<float> light_map(const Bench& bench, int width) {
  if (bench.options().probe.empty()) return sky(width);
  const RadianceMap map = read_map(bench.options().probe).map;
  if (map.rgb.width() != 2 * map.rgb.height()) {
    throw Error(bench.options().probe.string() + ": is no lat-long of 2:1; make one with hdr unwrap --to latlong");
  }
  return resize(map.rgb, {width, width / 2});
}

std::string light_name(const Bench& bench) {
  return bench.options().probe.empty() ? "an invented sunny sky" : bench.options().probe.filename().string();
}

}  // namespace hdr::bench
