#include "tests/bench/row.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hdr::bench {
namespace {

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string();
}

std::string pad(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 0, ' ');
}

std::string table_line(const Row& row, std::size_t subject_width, std::size_t value_width) {
  const std::string error =
      std::isfinite(row.error) ? short_number(row.error) + " " + row.error_unit : std::string("-");
  const bool memory = row.peak_bytes >= 0;
  std::string line =
      fmt::format("    {}  {}  {:>14}  {:>9} CPU  {:>9}  {:>8}", pad(row.subject, subject_width),
                  pad(row.knob + " " + text_of_value(row), value_width), error, short_seconds(row.cpu_seconds),
                  short_seconds(row.wall_seconds), memory ? short_bytes(row.peak_bytes) : std::string("-"));
  if (!row.note.empty()) line += "  " + row.note;
  return line + "\n";
}

}  // namespace

std::string short_number(double value) {
  if (!std::isfinite(value)) return "-";
  if (value == 0) return "0";
  const double size = std::abs(value);
  if (size < 1e-4 || size >= 1e6) return fmt::format("{:.1e}", value);
  const int digits = std::max(0, 2 - static_cast<int>(std::floor(std::log10(size))));
  std::string text = fmt::format("{:.{}f}", value, digits);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

std::string short_seconds(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  if (seconds < 1e-3) return short_number(1e6 * seconds) + " us";
  if (seconds < 1) return short_number(1e3 * seconds) + " ms";
  return short_number(seconds) + " s";
}

std::string short_bytes(std::int64_t bytes) {
  if (bytes < 0) return "-";
  const auto size = static_cast<double>(bytes);
  return size < 1e6 ? short_number(size / 1e3) + " kB" : short_number(size / 1e6) + " MB";
}

std::string text_of_value(const Row& row) {
  return row.label.empty() ? short_number(row.value) : row.label;
}

std::string csv_of(const std::vector<Row>& rows) {
  std::string text =
      "suite,stage,subject,knob,value,error,error_name,error_unit,cpu_seconds,median_cpu_seconds,wall_seconds,"
      "peak_bytes,megapixels,threads,note,setting\n";
  for (const Row& row : rows) {
    const std::string value = row.label.empty() ? csv_number(row.value) : csv_text(row.label);
    const std::string peak = row.peak_bytes < 0 ? std::string() : std::to_string(row.peak_bytes);
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_text(row.suite), csv_text(row.stage),
                        csv_text(row.subject), csv_text(row.knob), value, csv_number(row.error),
                        csv_text(row.error_name), csv_text(row.error_unit), csv_number(row.cpu_seconds),
                        csv_number(row.median_cpu_seconds), csv_number(row.wall_seconds), peak,
                        csv_number(row.megapixels), row.threads, csv_text(row.note), csv_text(row.setting));
  }
  return text;
}

std::string table_of(const std::vector<Row>& rows) {
  std::size_t subject_width = 0, value_width = 0;
  for (const Row& row : rows) {
    subject_width = std::max(subject_width, row.subject.size());
    value_width = std::max(value_width, row.knob.size() + 1 + text_of_value(row).size());
  }
  std::string text, suite, stage;
  for (const Row& row : rows) {
    if (row.suite != suite) text += (text.empty() ? "" : "\n") + (suite = row.suite) + "\n";
    if (row.stage != stage) text += fmt::format("  {}: {}\n", stage = row.stage, row.error_name);
    text += table_line(row, subject_width, value_width);
  }
  return text;
}

}  // namespace hdr::bench
