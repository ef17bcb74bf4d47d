#pragma once
// A verb of the command: one short file each, listed in main.cpp's table.
#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "libhdr/core/stage.h"
#include "tools/hdr/progress.h"

namespace hdr::tools {

using Json = nlohmann::ordered_json;

/// One run of the command: what every verb shares.
struct Run {
  bool json = false;
  bool quiet = false;
  int threads = 0;
  std::string options;  ///< the options that change pixels, for provenance
  StageClock clock;
  Json answer = Json::object();

  /// A line of the result on stdout; nothing with --json or --quiet.
  void say(const std::string& line) const;
  /// A warning on stderr (kept out of stdout, and silent with --quiet), and in the answer's "warnings".
  void warn(const std::string& line);

  /// Times a stage; a bar on a terminal when it takes over a second.
  template <class Work>
  decltype(auto) stage(const std::string& name, Work&& work) {
    const Progress progress(name, quiet || json);
    return clock.run(name, [&]() -> decltype(auto) {
      if constexpr (std::is_invocable_v<Work, const Progress&>) {
        return work(progress);
      } else {
        return work();
      }
    });
  }
};

/// Declares the verb's options on `app` and returns what to do once they are parsed: an exit code.
using Declare = std::function<int(Run&)> (*)(CLI::App& app);

struct Verb {
  const char* name;
  const char* group;
  const char* sentence;
  const char* example;  ///< a line that runs
  Declare declare;
};

std::function<int(Run&)> declare_info(CLI::App& app);
std::function<int(Run&)> declare_simulate(CLI::App& app);
std::function<int(Run&)> declare_shoot(CLI::App& app);
std::function<int(Run&)> declare_cameras(CLI::App& app);
std::function<int(Run&)> declare_calibrate(CLI::App& app);
std::function<int(Run&)> declare_align(CLI::App& app);
std::function<int(Run&)> declare_merge(CLI::App& app);
std::function<int(Run&)> declare_unwrap(CLI::App& app);
std::function<int(Run&)> declare_stitch(CLI::App& app);
std::function<int(Run&)> declare_probe(CLI::App& app);
std::function<int(Run&)> declare_sh(CLI::App& app);
std::function<int(Run&)> declare_lights(CLI::App& app);
std::function<int(Run&)> declare_unclip(CLI::App& app);
std::function<int(Run&)> declare_prefilter(CLI::App& app);
std::function<int(Run&)> declare_prt(CLI::App& app);
std::function<int(Run&)> declare_render(CLI::App& app);
std::function<int(Run&)> declare_composite(CLI::App& app);
std::function<int(Run&)> declare_tonemap(CLI::App& app);
std::function<int(Run&)> declare_fuse(CLI::App& app);
std::function<int(Run&)> declare_filter(CLI::App& app);
std::function<int(Run&)> declare_convert(CLI::App& app);
std::function<int(Run&)> declare_diff(CLI::App& app);
std::function<int(Run&)> declare_bench(CLI::App& app);

}  // namespace hdr::tools
