// Radiance maps in files: what a format costs and loses, beside OpenImageIO alone.
#include <fmt/format.h>

#include <cmath>

#include "libhdr/core/parallel.h"
#include "libhdr/io/read.h"
#include "libhdr/io/write.h"
#include "tests/bench/rivals/openimageio.h"
#include "tests/bench/rivals/programs.h"
#include "tests/bench/suites/light_map.h"
#include "tests/bench/suites/suite.h"
#include "tests/support/scene.h"
#include "tests/support/scratch.h"

namespace hdr::bench {
namespace {

struct Format {
  const char *name, *extension, *compression;
  SampleType type;
  bool oiio_writes;
};
constexpr Format kFormats[] = {{"EXR half none", ".exr", "none", SampleType::kHalf, true},
                               {"EXR half piz", ".exr", "piz", SampleType::kHalf, true},
                               {"EXR half zip", ".exr", "zip", SampleType::kHalf, true},
                               {"EXR half b44", ".exr", "b44", SampleType::kHalf, true},
                               {"EXR half dwaa", ".exr", "dwaa", SampleType::kHalf, true},
                               {"EXR float zip", ".exr", "zip", SampleType::kFloat, true},
                               {"EXR float pxr24", ".exr", "pxr24", SampleType::kFloat, true},
                               {"Radiance RGBE", ".hdr", "", SampleType::kFloat, true},
                               {"TIFF float zip", ".tif", "zip", SampleType::kFloat, true},
                               {"TIFF LogLuv", ".tif", "logluv", SampleType::kFloat, false},
                               {"TIFF Pixar log", ".tif", "pixarlog", SampleType::kFloat, false},
                               {"PFM", ".pfm", "", SampleType::kFloat, false}};
constexpr double kSane = 50;  // %

/// Ten stops, and a highlight of 10^4.
RadianceMap test_map(Size size) {
  RadianceMap map;
  map.rgb = test::test_scene(size.width, size.height, 10, 3);
  for (int c = 0; c < 3; ++c) map.rgb(size.width / 2, size.height / 3, c) = 1e4f;
  return map;
}

/// Rms of the relative error of a sample, in percent.
double percent_lost(const Image<float>& read, const Image<float>& written) {
  double squares = 0;
  if (read.size() != written.size()) return kUnknown;
  for (int y = 0; y < read.height(); ++y) {
    for (std::size_t k = 0; k < read.row_samples(); ++k) {
      squares += std::pow(static_cast<double>(read.row(y)[k]) / written.row(y)[k] - 1, 2);
    }
  }
  return 100 * std::sqrt(squares / (static_cast<double>(read.row_samples()) * read.height()));
}

Row row_of(const std::string& stage, const std::string& subject, const Format& format, Size size) {
  Row row{"files", stage, subject, "format"};
  row.label = format.name;
  row.error_name = "rms of what a sample loses";
  row.error_unit = "%";
  row.megapixels = megapixels(size);
  return row;
}

std::string setting_of(const Format& format) {
  const std::string path =
      Path(format.extension) == ".exr"
          ? fmt::format("{} --type {}", format.extension, format.type == SampleType::kHalf ? "half" : "float")
          : format.extension;
  return fmt::format("hdr convert in.exr out{}{}", path,
                     *format.compression ? fmt::format(" --compression {}", format.compression) : "");
}

void by_format(Bench& bench) {
  const Size size = bench.pick(Size{768, 384}, Size{4096, 2048});
  const RadianceMap map = test_map(size);
  const support::ScratchFolder folder;
  const std::string writing = fmt::format("writing a {}x{} map", size.width, size.height);
  const std::string reading = fmt::format("reading a {}x{} map", size.width, size.height);
  for (const Format& format : kFormats) {
    const Path ours = folder / (std::string("ours") + format.extension);
    const Path theirs = folder / (std::string("theirs") + format.extension);
    std::vector<Contender> contenders;
    Row row = row_of(writing, "hdr", format, size);
    row.setting = setting_of(format);
    contenders.push_back({row,
                          [&] {
                            write_map(ours, map, {}, {format.type, format.compression, false});
                          },
                          [&] { return percent_lost(read_map(ours).map.rgb, map.rgb); }, kSane});
    if (format.oiio_writes) {
      contenders.push_back(
          {row_of(writing, "OpenImageIO alone", format, size),
           [&] { write_by_oiio(theirs, map.rgb, format.type == SampleType::kHalf, format.compression); },
           [&] { return percent_lost(read_by_oiio(theirs), map.rgb); }, kSane});
    }
    bench.race(std::move(contenders));
    Image<float> read_ours, read_theirs;
    Contender oiio{row_of(reading, "OpenImageIO alone", format, size), [&] { read_theirs = read_by_oiio(ours); },
                   [&] { return percent_lost(read_theirs, map.rgb); }, kSane};
    bench.race({{row_of(reading, "hdr", format, size), [&] { read_ours = read_map(ours).map.rgb; },
                 [&] { return percent_lost(read_ours, map.rgb); }, kSane},
                std::move(oiio)});
  }
}

/// From one file to another, start of the program and all.
void against_oiiotool(Bench& bench) {
  const Size size = bench.pick(Size{1024, 512}, Size{4096, 2048});
  const RadianceMap map = test_map(size);
  const support::ScratchFolder folder;
  const Path input = folder / "in.exr", ours = folder / "ours.hdr", theirs = folder / "theirs.hdr";
  write_map(input, map, {}, {SampleType::kFloat, "zip", false});
  const Format format{"float EXR to RGBE", ".hdr", "", SampleType::kFloat, true};
  const std::string stage = fmt::format("commands: a {}x{} map from EXR to Radiance", size.width, size.height);
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  std::vector<Contender> contenders;
  contenders.push_back(
      {row_of(stage, "hdr convert", format, size),
       [&] {
         run_shell(fmt::format("{} convert {} {} --quiet", shell_word(self), shell_word(input), shell_word(ours)));
       },
       [&] { return percent_lost(read_map(ours).map.rgb, map.rgb); }, kSane});
  if (find_program("oiiotool")) {
    contenders.push_back({row_of(stage, "oiiotool", format, size),
                          [&] { run_shell(fmt::format("oiiotool {} -o {}", shell_word(input), shell_word(theirs))); },
                          [&] { return percent_lost(read_map(theirs).map.rgb, map.rgb); }, kSane});
  } else {
    bench.absent("oiiotool", "apt-get install openimageio-tools");
  }
  bench.race(std::move(contenders));
}

void by_megapixels(Bench& bench) {
  for (const int width : bench.quick() ? std::vector<int>{256, 512, 1024} : std::vector<int>{1024, 2048, 4096, 8192}) {
    const RadianceMap map = test_map({width, width / 2});
    const support::ScratchFolder folder;
    const Path path = folder / "map.exr";
    Row writing{"files", "half EXR piz, by size", "hdr, writing", "megapixels"};
    writing.value = writing.megapixels = megapixels(map.rgb.size());
    Row reading = writing;
    reading.subject = "hdr, reading";
    bench.race({{writing, [&] { write_map(path, map); }}, {reading, [&] { read_map(path); }}});
  }
}

}  // namespace

void files_suite(Bench& bench) {
  bench.attempt("files", "by format", [&] { by_format(bench); });
  bench.attempt("files", "commands", [&] { against_oiiotool(bench); });
  bench.attempt("files", "by size", [&] { by_megapixels(bench); });
}

}  // namespace hdr::bench
