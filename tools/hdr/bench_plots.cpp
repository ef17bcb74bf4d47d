#include "tools/hdr/bench_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/hdr/report/assets.h"
#include "tools/hdr/report/html.h"
#include "tools/hdr/report/plot.h"

namespace hdr::tools {
namespace {

using bench::Row;

bool scales(const Row& row) {
  return row.knob == "threads" || row.knob == "megapixels";
}

std::vector<std::string> distinct(const std::vector<Row>& rows, std::string Row::*field) {
  std::vector<std::string> names;
  for (const Row& row : rows) {
    if (std::find(names.begin(), names.end(), row.*field) == names.end()) names.push_back(row.*field);
  }
  return names;
}

std::string note_of(const Row& row) {
  std::string text = fmt::format("{}, {} {}: ", row.subject, row.knob, bench::text_of_value(row));
  if (std::isfinite(row.error)) text += fmt::format("{} {}, ", bench::short_number(row.error), row.error_unit);
  text += row.time_name.empty() ? fmt::format("{} CPU, {} wall", bench::short_seconds(row.cpu_seconds),
                                              bench::short_seconds(row.wall_seconds))
                                : fmt::format("{} {}", bench::short_number(row.wall_seconds), row.time_name);
  if (row.peak_bytes >= 0) text += ", " + bench::short_bytes(row.peak_bytes);
  return text;
}

/// A logarithmic axis has no place for an exact answer: it is drawn under all others.
double floor_of_errors(const std::vector<Row>& rows) {
  double least = std::numeric_limits<double>::infinity();
  for (const Row& row : rows) {
    if (row.error > 0 && row.error < least) least = row.error;
  }
  return std::isfinite(least) ? least / 10 : 1e-3;
}

/// One subject's curve through `rows`; looks follow its place among all.
report::Series series_of(const std::string& subject, std::size_t place) {
  constexpr std::size_t kColours = 6;
  report::Series series;
  series.name = subject;
  series.mark = report::Mark::kCurve;
  series.colour = report::colour_in_turn(place);
  series.shape = static_cast<int>((place + place / kColours) % 4);
  series.dash = static_cast<int>((place / kColours + place) % 4);
  return series;
}

report::Plot effort_plot(const std::vector<Row>& rows) {
  report::Plot plot;
  plot.title = rows[0].stage;
  plot.x = {rows[0].time_name.empty() ? "CPU time (s)" : rows[0].time_name, true, {}, {}, {}, false};
  plot.y = {fmt::format("error ({})", rows[0].error_unit), true, {}, {}, {}, false};
  const double exact = floor_of_errors(rows);
  const std::vector<std::string> subjects = distinct(rows, &Row::subject);
  for (std::size_t k = 0; k < subjects.size(); ++k) {
    report::Series series = series_of(subjects[k], k);
    for (const Row& row : rows) {
      if (row.subject != subjects[k] || !row.timed() || !std::isfinite(row.error)) continue;
      series.x.push_back(row.time());
      series.y.push_back(row.error > 0 ? row.error : exact);
      series.notes.push_back(note_of(row));
      // Formats and kernels are no scale: no line leads from one to the next.
      if (!row.label.empty() && row.label != "auto" && row.label != "all") series.mark = report::Mark::kPoints;
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  return plot;
}

report::Plot scaling_plot(const std::vector<Row>& rows) {
  report::Plot plot;
  const bool by_threads = rows[0].knob == "threads";
  plot.title = rows[0].stage;
  plot.x = {by_threads ? "threads" : "picture (megapixels)", true, {}, {}, {}, false};
  plot.y = {by_threads ? "time (s)" : "CPU time (s)", true, {}, {}, {}, false};
  if (by_threads) {
    for (const Row& row : rows) plot.x.ticks.push_back({row.value, bench::short_number(row.value)});
  }
  const std::vector<std::string> subjects = distinct(rows, &Row::subject);
  std::size_t place = 0;
  for (const std::string& subject : subjects) {
    for (const bool wall : {true, false}) {
      if (wall && !by_threads) continue;
      report::Series series =
          series_of(by_threads ? subject + (wall ? ", wall clock" : ", CPU, all threads") : subject, place++);
      for (const Row& row : rows) {
        if (row.subject != subject || !row.timed()) continue;
        series.x.push_back(row.value);
        series.y.push_back(wall ? row.wall_seconds : row.cpu_seconds);
        series.notes.push_back(note_of(row));
      }
      if (!series.x.empty()) plot.series.push_back(std::move(series));
    }
  }
  return plot;
}

}  // namespace

std::string bench_plots(const std::vector<Row>& rows) {
  std::string figures;
  for (const std::string& stage : distinct(rows, &Row::stage)) {
    std::vector<Row> of_stage;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(of_stage),
                 [&](const Row& row) { return row.stage == stage; });
    if (of_stage[0].suite == "skips") continue;
    const bool scaling = scales(of_stage[0]);
    const report::Plot plot = scaling ? scaling_plot(of_stage) : effort_plot(of_stage);
    if (plot.series.empty()) continue;
    const std::string caption = scaling
                                    ? "Least of several interleaved runs."
                                    : fmt::format("Error: {}. To the left and down is better.", of_stage[0].error_name);
    figures += report::figure(report::html_of(plot), caption);
  }
  return figures.empty() ? figures : "<div class=\"figures\">" + figures + "</div>\n";
}

}  // namespace hdr::tools
