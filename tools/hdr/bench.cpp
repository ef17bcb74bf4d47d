// Time against error of every stage, on this machine.
#include "tests/bench/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/io/output_file.h"
#include "libhdr/io/write.h"
#include "tests/bench/advice.h"
#include "tests/bench/machine.h"
#include "tests/bench/suites/suite.h"
#include "tools/hdr/bench_report.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {
namespace {

struct Options {
  std::vector<std::string> suites;
  bool quick = false;
  std::string output, csv, probe, scene, pictures;
};

std::vector<std::string> suite_names() {
  std::vector<std::string> names;
  for (const bench::Suite& suite : bench::suites()) names.emplace_back(suite.name);
  return names;
}

std::string help_of_suites() {
  std::string text = "which; default: all of\n";
  for (const bench::Suite& suite : bench::suites()) text += fmt::format("{}: {}\n", suite.name, suite.sentence);
  return text;
}

Json number_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json json_of(const bench::Row& row) {
  return {{"suite", row.suite},
          {"stage", row.stage},
          {"subject", row.subject},
          {"knob", row.knob},
          {"value", row.label.empty() ? number_or_null(row.value) : Json(row.label)},
          {"error", number_or_null(row.error)},
          {"error_name", row.error_name},
          {"error_unit", row.error_unit},
          {"cpu_seconds", number_or_null(row.cpu_seconds)},
          {"median_cpu_seconds", number_or_null(row.median_cpu_seconds)},
          {"wall_seconds", number_or_null(row.wall_seconds)},
          {"peak_bytes", row.peak_bytes < 0 ? Json() : Json(row.peak_bytes)},
          {"megapixels", number_or_null(row.megapixels)},
          {"threads", row.threads},
          {"note", row.note},
          {"setting", row.setting}};
}

Json json_of(const bench::Machine& machine) {
  Json versions = Json::object();
  for (const auto& [name, version] : machine.versions) versions[name] = version;
  return {{"processor", machine.processor},
          {"cores", machine.cores},
          {"memory_bytes", machine.memory_bytes},
          {"system", machine.system},
          {"versions", versions}};
}

std::vector<const bench::Suite*> wanted(const Options& options) {
  std::vector<const bench::Suite*> chosen;
  for (const bench::Suite& suite : bench::suites()) {
    const bool named = std::find(options.suites.begin(), options.suites.end(), suite.name) != options.suites.end();
    if (options.suites.empty() || named) chosen.push_back(&suite);
  }
  return chosen;
}

void tell(Run& run, const bench::Bench& all, const std::vector<const bench::Suite*>& suites) {
  run.say(bench::table_of(all.rows()));
  Json rows = Json::array(), absent = Json::array(), advice = Json::object();
  for (const bench::Row& row : all.rows()) rows.push_back(json_of(row));
  for (const bench::Absent& rival : all.absentees()) {
    absent.push_back({{"name", rival.name}, {"remedy", rival.remedy}});
    run.say(fmt::format("absent: {}; {}", rival.name, rival.remedy));
  }
  for (const bench::Suite* suite : suites) {
    const std::string words = bench::advice_of(*suite, all.rows());
    if (words.empty()) continue;
    advice[suite->name] = words;
    run.say(fmt::format("{}: {}", suite->name, words));
  }
  run.answer["quick"] = all.quick();
  run.answer["rows"] = std::move(rows);
  run.answer["absent"] = std::move(absent);
  run.answer["advice"] = std::move(advice);
  run.answer["machine"] = json_of(bench::this_machine());
}

/// Each suite's seconds follow by themselves, as those of every verb's stages.
void tell_seconds(Run& run) {
  double wall = 0, cpu = 0;
  for (const Stage& stage : run.clock.stages()) wall += stage.seconds, cpu += stage.cpu_seconds;
  run.say(fmt::format("all suites: {:.1f} s, {:.1f} CPU s; of these", wall, cpu));
}

void write_pictures(Run& run, const Options& options, const bench::Bench& all) {
  if (options.pictures.empty()) return;
  std::filesystem::create_directories(options.pictures);
  for (const bench::Picture& picture : all.pictures()) {
    const Path path = Path(options.pictures) / (picture.name + ".png");
    write_picture(path, picture.codes);
    run.say("wrote " + path.string());
  }
}

}  // namespace

std::function<int(Run&)> declare_bench(CLI::App& app) {
  auto options = std::make_shared<Options>();
  app.add_option("suites", options->suites, help_of_suites())->check(CLI::IsMember(suite_names()).description(""));
  app.add_flag("--quick", options->quick, "small pictures and few runs: all suites in a minute");
  app.add_option("-o,--output", options->output, "a report with plots: one page, for any browser (.html)");
  app.add_option("--csv", options->csv, "write the rows as a table");
  app.add_option("--probe", options->probe, "a lat-long for the suites of light (default: an invented sunny sky)");
  app.add_option("--scene", options->scene, "a mesh (.obj) for those that render (default: spheres on a plane)");
  app.add_option("--pictures", options->pictures, "a folder for the pictures of `lecture` (.png)");
  return [options](Run& run) {
    bench::Bench all({options->quick, options->probe, options->scene});
    const std::vector<const bench::Suite*> suites = wanted(*options);
    for (const bench::Suite* suite : suites) {
      run.stage(suite->name, [&] { all.attempt(suite->name, "the whole suite", [&] { suite->run(all); }); });
    }
    tell(run, all, suites);
    if (!options->output.empty()) {
      run.stage("report", [&] { write_text(options->output, bench_report(all, suites, run)); });
      run.say("wrote " + options->output);
    }
    if (!options->csv.empty()) {
      write_text(options->csv, bench::csv_of(all.rows()));
      run.say("wrote " + options->csv);
    }
    write_pictures(run, *options, all);
    tell_seconds(run);
    return 0;
  };
}

}  // namespace hdr::tools
