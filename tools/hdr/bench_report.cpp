#include "tools/hdr/bench_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libhdr/io/output_file.h"
#include "libhdr/io/write.h"
#include "tests/bench/advice.h"
#include "tests/bench/machine.h"
#include "tests/support/scratch.h"
#include "tools/hdr/bench_plots.h"
#include "tools/hdr/report/assets.h"
#include "tools/hdr/report/embed.h"
#include "tools/hdr/report/html.h"
#include "tools/hdr/report/page.h"
#include "tools/hdr/report_common.h"

namespace hdr::tools {
namespace {

using bench::Bench;
using bench::Row;
using bench::Suite;

std::string html_of_machine() {
  const bench::Machine machine = bench::this_machine();
  report::Facts facts;
  facts.add("processor", machine.processor);
  facts.add("cores", std::to_string(machine.cores));
  facts.add("memory", fmt::format("{:.1f} GB", 1e-9 * static_cast<double>(machine.memory_bytes)));
  facts.add("system", machine.system);
  for (const auto& [name, version] : machine.versions) facts.add(name, version);
  return facts.html();
}

std::string table_of_rows(const std::vector<Row>& rows) {
  report::Table table({{"stage", false},
                       {"subject", false},
                       {"setting", false},
                       {"error", true},
                       {"CPU", true},
                       {"wall", true},
                       {"memory", true},
                       {"", false}});
  for (const Row& row : rows) {
    const std::string error =
        std::isfinite(row.error) ? bench::short_number(row.error) + " " + row.error_unit : std::string();
    const std::string wall =
        row.time_name.empty() ? bench::short_seconds(row.wall_seconds) : bench::short_number(row.wall_seconds) + " s";
    table.row({row.stage, row.subject, row.knob + " " + bench::text_of_value(row), error,
               bench::short_seconds(row.cpu_seconds), wall, bench::short_bytes(row.peak_bytes), row.note});
  }
  return "<details><summary>All rows</summary>\n" + table.html() + "</details>\n";
}

/// A skip is two rows: all done, and with what the scene does not need left out. What failed is one row that says why.
std::string table_of_skips(const std::vector<Row>& rows) {
  report::Table table({{"what is skipped", false},
                       {"scene", false},
                       {"all done", true},
                       {"skipping", true},
                       {"change of the answer", true},
                       {"", false}});
  const auto cpu = [](const Row& row) { return row.timed() ? bench::short_seconds(row.cpu_seconds) + " CPU" : "-"; };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const bool paired = k + 1 < rows.size() && rows[k + 1].stage == rows[k].stage && rows[k + 1].label == rows[k].label;
    const Row &all = rows[k], &skipping = paired ? rows[++k] : all;
    const std::string changed =
        std::isfinite(skipping.error) ? bench::short_number(skipping.error) + " " + skipping.error_unit : "-";
    table.row({all.stage, all.label, paired ? cpu(all) : "-", cpu(skipping), changed, skipping.note});
  }
  return table.html();
}

/// What must be expected is the condition number in roundings; how much more or less came of it is the growth.
std::string table_of_numerics(const std::vector<Row>& rows) {
  report::Table table({{"problem", false},
                       {"by", false},
                       {"", false},
                       {"", true},
                       {"error (roundings of 1.1e-16)", true},
                       {"error / condition", true}});
  for (const Row& row : rows) {
    const bool conditioned = row.knob == "condition number";
    table.row({row.stage, row.subject, row.knob, bench::text_of_value(row), bench::short_number(row.error),
               conditioned ? bench::short_number(row.error / row.value) : "-"});
  }
  return table.html();
}

std::string html_of_picture(const bench::Picture& picture) {
  const support::ScratchFolder folder;
  const Path file = folder / "picture.png";
  write_picture(file, picture.codes);
  const std::string image =
      fmt::format("<img alt=\"{}\" style=\"max-width:100%;height:auto\" src=\"data:image/png;base64,{}\"/>",
                  report::escaped(picture.caption), report::base64(read_text(file)));
  return report::figure(image, picture.caption, true);
}

std::string html_of_suite(const Bench& all, const Suite& suite) {
  std::vector<Row> rows;
  std::copy_if(all.rows().begin(), all.rows().end(), std::back_inserter(rows),
               [&](const Row& row) { return row.suite == suite.name; });
  if (rows.empty()) return {};
  std::string html = report::element("p", std::string(suite.sentence) + ".");
  const std::string words = bench::advice_of(suite, rows);
  if (!words.empty()) html += "<p><strong>" + report::with_code(words) + "</strong></p>\n";
  if (std::string(suite.name) == "skips") return html + table_of_skips(rows);
  if (std::string(suite.name) == "numerics") return html + bench_plots(rows, suite.target) + table_of_numerics(rows);
  if (std::string(suite.name) == "lecture") {
    for (const bench::Picture& picture : all.pictures()) html += html_of_picture(picture);
  }
  return html + bench_plots(rows, suite.target) + table_of_rows(rows);
}

std::string html_of_absent(const Bench& all) {
  std::vector<std::string> sentences;
  for (const bench::Absent& rival : all.absentees()) sentences.push_back(rival.name + ": " + rival.remedy);
  return report::list(sentences);
}

}  // namespace

std::string bench_report(const Bench& all, const std::vector<const Suite*>& suites, const Run& run) {
  const bench::Machine machine = bench::this_machine();
  report::Page page(
      "hdr bench: time against error",
      fmt::format("Measured on {}, {} cores{}. Times are CPU seconds of all threads, the least of several "
                  "interleaved runs; every answer was checked before it was timed.",
                  machine.processor, machine.cores, all.quick() ? ", quickly: small pictures and few runs" : ""));
  report::Table advice({{"suite", false}, {"which setting", false}});
  for (const Suite* suite : suites) {
    const std::string words = bench::advice_of(*suite, all.rows());
    if (!words.empty()) advice.row({suite->name, words});
  }
  if (!advice.empty()) page.add({"which", "Which setting to use", advice.html()});
  for (const Suite* suite : suites) page.add({suite->name, suite->name, html_of_suite(all, *suite)});
  page.add({"absent", "Not there", html_of_absent(all)});
  add_stages(page, run);
  page.add({"machine", "The machine", html_of_machine()});
  page.use(report::assets::kPlotScript);
  return page.text();
}

}  // namespace hdr::tools
