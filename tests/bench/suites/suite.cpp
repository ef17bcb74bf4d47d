#include "tests/bench/suites/suite.h"

namespace hdr::bench {

const std::vector<Suite>& suites() {
  static const std::vector<Suite> all = {
      {"calibrate", "the camera's response: points used, against the true curve", calibrate_suite},
      {"merge", "a bracket to a map: shots, against the true radiance", merge_suite},
      {"align", "registration of shaken shots, against the true motion", align_suite, {0.25, "px"}},
      {"unwrap", "a mirror ball to a lat-long: width, against the true world", unwrap_suite},
      {"sh", "spherical harmonics: degree, against irradiance from every pixel", sh_suite},
      {"lights", "a probe as N directional lights: N, against irradiance from every pixel", lights_suite},
      {"render", "a scene lit by a probe: samples by every method, against a converged render", render_suite},
      {"capture-plan", "shots planned or on a grid, against what the scene holds", capture_plan_suite},
      {"files", "formats, against what was written", files_suite},
      {"filter", "Gaussian blurs: sigma, against the exact sum", filter_suite},
      {"lecture", "the lecture's series of 2003 again, against a converged render", lecture_suite},
      {"skips", "what a scene does not need is not done: the answer without, against the answer with", skips_suite},
      {"numerics", "digits that are lost: condition numbers, against long double", numerics_suite},
  };
  return all;
}

const Suite* find_suite(const std::string& name) {
  for (const Suite& suite : suites()) {
    if (name == suite.name) return &suite;
  }
  return nullptr;
}

}  // namespace hdr::bench
