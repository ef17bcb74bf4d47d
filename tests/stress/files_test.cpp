// Files of hostile pictures: every format keeps its promise for 1e-12 .. 1e12, denormals, NaN and infinities, 1x1 and
// long thin pictures, or refuses in words.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "libhdr/io/bracket.h"
#include "libhdr/io/exposure_list.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/stress/hostile.h"
#include "tests/support/support.h"

namespace hdr::stress {
namespace {

struct Format {
  const char *name, *compression;
  SampleType type;
  double relative, share_of_pixel;  ///< what a sample may lose, of itself and of its pixel's largest
  double smallest, largest;         ///< what the format holds
};
constexpr Format kFormats[] = {{"f.exr", "zip", SampleType::kFloat, 0, 0, 0, 3e38},
                               {"n.exr", "none", SampleType::kFloat, 0, 0, 0, 3e38},
                               {"p.exr", "piz", SampleType::kHalf, 5e-4, 0, 6.2e-5, 65504},
                               {"r.hdr", "", SampleType::kFloat, 0, 4e-3, 1e-30, 1e30},
                               {"m.pfm", "", SampleType::kFloat, 0, 0, 0, 3e38},
                               {"t.tif", "zip", SampleType::kFloat, 0, 0, 0, 3e38}};

RC_GTEST_PROP(FilesStress, MapsComeBackOrAreRefused, ()) {
  MapPlan plan = *any_map(20);
  if (*rc::gen::inRange(0, 10) == 0)
    plan.width = *rc::gen::element(1, 100000), plan.height = plan.width == 1 ? 100000 : 1;
  const Format& format = kFormats[*rc::gen::inRange<std::size_t>(0, std::size(kFormats))];
  RadianceMap map;
  map.rgb = made(plan);
  const test::ScratchDir folder;
  const Path path = folder / format.name;
  try {
    write_map(path, map, {}, {format.type, format.compression, false});
  } catch (const Error& e) {
    RC_ASSERT(std::strlen(e.what()) > 10u);
    RC_ASSERT(largest_of(map.rgb) > format.largest);
    RC_ASSERT(!std::filesystem::exists(path));
    return;
  }
  const RadianceMap back = read_map(path).map;
  RC_ASSERT(back.rgb.size() == map.rgb.size());
  for (int y = 0; y < plan.height; ++y) {
    for (int x = 0; x < plan.width; ++x) {
      const float* p = map.rgb.pixel(x, y);
      const double most = std::max({p[0], p[1], p[2]});
      for (int c = 0; c < 3; ++c) {
        const double off = std::abs(static_cast<double>(back.rgb(x, y, c)) - p[c]);
        RC_ASSERT(off <= format.relative * p[c] + format.share_of_pixel * most + format.smallest);
      }
    }
  }
}

// What is no number becomes one, is counted, and said.
RC_GTEST_PROP(FilesStress, WhatIsNoNumberIsReplacedAndSaid, ()) {
  const MapPlan plan = *any_map(20);
  RadianceMap map;
  map.rgb = made(plan);
  spoil(map.rgb, plan.seed);
  map.rgb(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
  const test::ScratchDir folder;
  const Path path = folder / *rc::gen::element("f.exr", "m.pfm", "t.tif");
  write_map(path, map, {}, {SampleType::kFloat, "zip", false});
  bool has_finite = false;
  for (int y = 0; y < plan.height; ++y) {
    for (std::size_t k = 0; k < map.rgb.row_samples(); ++k) has_finite |= std::isfinite(map.rgb.row(y)[k]);
  }
  try {
    const ReadMap read = read_map(path);
    RC_ASSERT(fault_of(read.map.rgb) == "");
    RC_ASSERT(!read.warnings.empty());
  } catch (const Error& e) {
    RC_ASSERT(!has_finite);  // nothing that light could be made of
  }
  const FileInfo info = read_info(path);
  RC_ASSERT(info.nan >= 1 && std::isfinite(info.mean));
}

RC_GTEST_PROP(FilesStress, ExposureListsEndInNumbersOrInWords, ()) {
  static const std::vector<std::string> kWords = {"a.jpg",  "1/60",  "1/0", "nan",      "inf",   "-1",
                                                  "1e-320", "1e308", "0",   "1/1e-300", "8",     "\"b c\"",
                                                  "#",      "\n",    "\n",  "\t",       "1e999", "9999999999999999999"};
  std::string text;
  const auto count = *rc::gen::inRange(0, 30);
  for (int k = 0; k < count; ++k) text += *rc::gen::elementOf(kWords) + " ";
  try {
    for (const ListedExposure& line :
         parse_exposure_list(text, "list", static_cast<ListFormat>(*rc::gen::inRange(0, 4)))) {
      if (const auto h = line.exposure.relative()) RC_ASSERT(std::isfinite(*h) && *h > 0);
    }
  } catch (const Error& e) {
    RC_ASSERT(std::strlen(e.what()) > 5u);
  }
}

// Photographs of a row or a column, and of one pixel.
RC_GTEST_PROP(FilesStress, PhotographsComeBack, ()) {
  BracketCase plan = *any_bracket(20);
  if (plan.bits != 8) plan.bits = 16;
  plan.kind = 4;
  if (*rc::gen::inRange(0, 10) == 0)
    plan.width = *rc::gen::element(1, 30000), plan.height = plan.width == 1 ? 30000 : 1;
  const Bracket bracket = made(plan);
  const test::ScratchDir folder;
  const Path path = folder / *rc::gen::element("p.png", "p.tif");
  write_photo(path, bracket.shots[0]);
  const Photo back = read_photo(path);
  RC_ASSERT(back.size() == bracket.shots[0].size() && back.bits == plan.bits);
  std::visit(
      [&](const auto& a) {
        const auto& b = std::get<std::decay_t<decltype(a)>>(back.codes);
        for (int y = 0; y < plan.height; ++y) {
          RC_ASSERT(std::memcmp(a.row(y), b.row(y), a.row_samples() * sizeof(*a.row(y))) == 0);
        }
      },
      bracket.shots[0].codes);
}

}  // namespace
}  // namespace hdr::stress
