#include "tools/hdr/report_common.h"

#include "libhdr/io/output_file.h"
#include "tools/hdr/report/assets.h"
#include "tools/hdr/report/html.h"
#include "tools/hdr/report/plot.h"

namespace hdr::tools {

void ReportFlag::declare(CLI::App& app) {
  app.add_option("--report", path, "also write what was done, as one HTML file to look at");
}

void ReportFlag::check() const {
  if (wanted()) const OutputFile place(path);
}

void add_warnings(report::Page& page, const Run& run) {
  std::vector<std::string> warnings;
  if (run.answer.contains("warnings")) {
    for (const Json& warning : run.answer["warnings"]) warnings.push_back(warning.get<std::string>());
  }
  page.add({"warnings", "Warnings", report::list(warnings, "warnings")});
}

void add_stages(report::Page& page, const Run& run) {
  const std::vector<Stage>& stages = run.clock.stages();
  if (stages.size() < 2) return;
  report::Table table({{"stage"}, {"seconds", true}, {"CPU seconds", true}, {"skipped, and why that is safe"}});
  report::Plot plot;
  plot.title = "Seconds of the stages";
  plot.x = {"seconds", false, 0.0};
  plot.y.reversed = true;
  report::Series wall{"wall clock", report::Mark::kSpans, report::Colour::kBlue};
  report::Series cpu{"CPU, all threads", report::Mark::kPoints, report::Colour::kVermilion};
  for (std::size_t k = 0; k + 1 < stages.size(); ++k) {
    const Stage& stage = stages[k];
    table.row({stage.name, report::number(stage.seconds), report::number(stage.cpu_seconds), stage.skipped});
    const auto row = static_cast<double>(k);
    plot.y.ticks.push_back({row, stage.name});
    wall.low.push_back(0);
    wall.x.push_back(stage.seconds);
    cpu.x.push_back(stage.cpu_seconds);
    for (report::Series* series : {&wall, &cpu}) {
      series->y.push_back(row);
      series->notes.push_back(stage.name + ": " + report::number(stage.seconds) + " s, CPU " +
                              report::number(stage.cpu_seconds) + " s");
    }
  }
  plot.height = 76 + 24 * static_cast<int>(stages.size() - 1);
  plot.series = {std::move(wall), std::move(cpu)};
  page.add({"time", "Time, and what was skipped", figures(page, {report::figure(html_of(plot), "")}) + table.html()});
}

std::string figures(report::Page& page, const std::vector<std::string>& figures) {
  page.use(report::assets::kPlotScript);
  std::string out = "<div class=\"figures\">\n";
  for (const std::string& figure : figures) out += figure;
  return out + "</div>\n";
}

}  // namespace hdr::tools
