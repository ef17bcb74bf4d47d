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

/// Across the whole plot, where the axis has its unit and the error comes near it.
void add_target(report::Plot& plot, const bench::Target& target, const std::string& unit) {
  if (unit != target.unit || plot.series.empty()) return;
  double first = std::numeric_limits<double>::infinity(), last = 0, least = first, most = 0;
  for (const report::Series& series : plot.series) {
    for (const double x : series.x) first = std::min(first, x), last = std::max(last, x);
    for (const double y : series.y) least = std::min(least, y), most = std::max(most, y);
  }
  if (!(first < last) || target.error < least / 3 || target.error > 3 * most) return;
  report::Series line{fmt::format("{} {}", bench::short_number(target.error), target.unit), report::Mark::kLine,
                      report::Colour::kInk};
  line.dash = 2;
  line.x = {first, last};
  line.y = {target.error, target.error};
  plot.series.push_back(std::move(line));
}

report::Plot effort_plot(const std::vector<Row>& rows, const bench::Target& target) {
  report::Plot plot;
  // A row that could not be measured may not know its units.
  const auto known = std::find_if(rows.begin(), rows.end(), [](const Row& row) { return std::isfinite(row.error); });
  const Row& first = known == rows.end() ? rows[0] : *known;
  plot.title = first.stage;
  plot.x = {first.time_name.empty() ? "CPU time (s)" : first.time_name, true, {}, {}, {}, false};
  plot.y = {fmt::format("error ({})", first.error_unit), true, {}, {}, {}, false};
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
  add_target(plot, target, first.error_unit);
  return plot;
}

std::string plot_error_name(const std::vector<Row>& rows) {
  for (const Row& row : rows) {
    if (!row.error_name.empty()) return row.error_name;
  }
  return {};
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

/// Error as the problem grows worse. Along the line it is what the condition alone must be expected to leave.
report::Plot numerics_plot(const std::vector<Row>& rows) {
  report::Plot plot;
  plot.title = rows[0].stage;
  plot.x = {rows[0].knob, true, {}, {}, {}, false};
  plot.y = {"error (roundings, 1.1e-16)", true, {}, {}, {}, false};
  const double exact = floor_of_errors(rows);
  const std::vector<std::string> subjects = distinct(rows, &Row::subject);
  report::Series expected{"what the condition alone allows", report::Mark::kLine, report::Colour::kInk};
  expected.dash = 2;
  for (std::size_t k = 0; k < subjects.size(); ++k) {
    report::Series series = series_of(subjects[k], k);
    for (const Row& row : rows) {
      if (row.subject != subjects[k] || !std::isfinite(row.error)) continue;
      series.x.push_back(row.value);
      series.y.push_back(row.error > 0 ? row.error : exact);
      series.notes.push_back(note_of(row));
      if (k == 0) expected.x.push_back(row.value), expected.y.push_back(row.value);
    }
    if (!series.x.empty()) plot.series.push_back(std::move(series));
  }
  if (rows[0].knob == "condition number") plot.series.push_back(std::move(expected));
  return plot;
}

}  // namespace

std::string bench_plots(const std::vector<Row>& rows, const bench::Target& target) {
  std::string figures;
  for (const std::string& stage : distinct(rows, &Row::stage)) {
    std::vector<Row> of_stage;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(of_stage),
                 [&](const Row& row) { return row.stage == stage; });
    if (of_stage[0].suite == "skips" || of_stage[0].knob == "nothing") continue;
    const bool scaling = scales(of_stage[0]), numerics = of_stage[0].suite == "numerics";
    const report::Plot plot = numerics  ? numerics_plot(of_stage)
                              : scaling ? scaling_plot(of_stage)
                                        : effort_plot(of_stage, target);
    if (plot.series.empty()) continue;
    const std::string caption =
        numerics  ? "Error: " + of_stage[0].error_name + ". Down is better."
        : scaling ? "Least of several interleaved runs."
                  : fmt::format("Error: {}. To the left and down is better.", plot_error_name(of_stage));
    figures += report::figure(report::html_of(plot), caption);
  }
  return figures.empty() ? figures : "<div class=\"figures\">" + figures + "</div>\n";
}

}  // namespace hdr::tools
