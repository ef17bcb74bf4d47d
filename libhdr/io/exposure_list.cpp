#include "libhdr/io/exposure_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <sstream>

#include "libhdr/core/error.h"

namespace hdr {
namespace {

/// What a column of numbers means.
enum class Column { kSeconds, kInverseSeconds, kFNumber, kIso, kGain, kNdStops, kIgnored };
using Columns = std::vector<Column>;

struct Line {
  int number;  ///< in the file, from 1
  std::string name;
  std::vector<double> values;
};

struct Lines {
  std::vector<Line> entries;
  std::optional<Columns> header;  ///< the columns after the name, when a line names them
};

[[noreturn]] void refuse(const std::string& list, int line, const std::string& fact) {
  throw Error(fmt::format("{}:{}: {}", list, line, fact));
}

/// Words of a line; a name with spaces stands in double quotes.
std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  std::string word;
  while (in >> std::ws && !in.eof() && in >> std::quoted(word)) words.push_back(word);
  return words;
}

/// "0.25", "1e-3" or "1/60".
std::optional<double> number_from(const std::string& word) {
  const char* text = word.c_str();
  char* end = nullptr;
  const double value = std::strtod(text, &end);
  if (end == text) return std::nullopt;
  if (*end == '\0') return value;
  if (*end != '/') return std::nullopt;
  const char* below = end + 1;
  const double divisor = std::strtod(below, &end);
  return end != below && *end == '\0' ? std::optional(value / divisor) : std::nullopt;
}

bool mentions(const std::string& word, const std::string& part) {
  return word.find(part) != std::string::npos;
}

std::optional<Column> column_from_word(std::string word) {
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (word.starts_with("1/")) return Column::kInverseSeconds;
  if (mentions(word, "gain")) return Column::kGain;
  if (mentions(word, "iso")) return Column::kIso;
  if (word.starts_with("nd")) return Column::kNdStops;
  if (word == "f" || word.starts_with("f/") || word.starts_with("f-") || word.starts_with("f_") ||
      mentions(word, "aperture")) {
    return Column::kFNumber;
  }
  if (mentions(word, "second") || mentions(word, "time") || word.starts_with("exposure") || word == "t") {
    return Column::kSeconds;
  }
  return std::nullopt;
}

/// A header is a line (a comment or not) that begins with a word for the name and goes on with known columns only.
std::optional<Columns> header_from(const std::vector<std::string>& words) {
  if (words.size() < 2) return std::nullopt;
  static constexpr std::array kNames = {"filename", "file", "name", "path", "image", "picture"};
  std::string first = words[0];
  std::transform(first.begin(), first.end(), first.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(kNames.begin(), kNames.end(), first) == kNames.end()) return std::nullopt;
  Columns columns;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto column = column_from_word(words[i]);
    if (!column) return std::nullopt;
    columns.push_back(*column);
  }
  return columns;
}

Line entry_from(const std::vector<std::string>& words, const std::string& list, int number) {
  Line line{number, words[0], {}};
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto value = number_from(words[i]);
    if (!value) refuse(list, number, fmt::format("'{}' is not a number; put a name with spaces in quotes", words[i]));
    line.values.push_back(*value);
  }
  return line;
}

Lines lines_from(const std::string& text, const std::string& list) {
  Lines lines;
  std::optional<std::pair<int, double>> count;  // Debevec's lists begin with the number of pictures
  std::istringstream in(text);
  std::string raw;
  for (int number = 1; std::getline(in, raw); ++number) {
    const auto comment = raw.find('#');
    if (comment != std::string::npos && !lines.header) lines.header = header_from(words_of(raw.substr(comment + 1)));
    const std::vector<std::string> words = words_of(raw.substr(0, comment));
    if (words.empty()) continue;
    if (words.size() == 1) {
      const auto value = number_from(words[0]);
      if (!value || count || !lines.entries.empty()) refuse(list, number, "no exposure time after '" + words[0] + "'");
      count = {number, *value};
    } else if (const auto header = header_from(words); header && !lines.header && lines.entries.empty()) {
      lines.header = header;
    } else {
      lines.entries.push_back(entry_from(words, list, number));
    }
  }
  if (lines.entries.empty()) throw Error(list + ": names no picture; write lines `name seconds [f-number [iso [nd]]]`");
  if (count && count->second != static_cast<double>(lines.entries.size())) {
    refuse(list, count->first, fmt::format("says {} pictures, but {} follow", count->second, lines.entries.size()));
  }
  return lines;
}

/// Do pictures brighten while the second field falls? Every pair of pictures votes.
bool brightens_while_falling(const std::vector<Line>& entries, const std::vector<std::optional<double>>& brightness) {
  int falling = 0, rising = 0;
  const std::size_t known = std::min(entries.size(), brightness.size());
  for (std::size_t i = 0; i < known; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (!brightness[i] || !brightness[j]) continue;
      const double vote = (entries[i].values[0] - entries[j].values[0]) * (*brightness[i] - *brightness[j]);
      if (vote < 0) ++falling;
      if (vote > 0) ++rising;
    }
  }
  return falling > rising;
}

/// hdrgen's fourth field is an ISO speed, Debevec's a gain in dB: cameras have no ISO below 25 and no gain above 24 dB.
bool fourth_field_is_iso(const std::vector<Line>& entries) {
  return std::all_of(entries.begin(), entries.end(),
                     [](const Line& line) { return line.values.size() >= 3 && line.values[2] >= 25; });
}

const Columns kSecondsColumns = {Column::kSeconds, Column::kFNumber, Column::kIso, Column::kNdStops};
const Columns kInverseColumns = {Column::kInverseSeconds, Column::kFNumber, Column::kGain, Column::kNdStops};
const Columns kHdrgenColumns = {Column::kInverseSeconds, Column::kFNumber, Column::kIso, Column::kIgnored};

/// A header that stops early (`name seconds`) means the usual columns after it.
Columns completed(const Columns& header) {
  for (const Columns& usual : {kSecondsColumns, kInverseColumns}) {
    if (header.size() < usual.size() && std::equal(header.begin(), header.end(), usual.begin())) return usual;
  }
  return header;
}

Columns columns_of(const Lines& lines, ListFormat format, const std::vector<std::optional<double>>& brightness) {
  if (format == ListFormat::kAuto) {
    if (lines.header) return completed(*lines.header);
    if (!brightens_while_falling(lines.entries, brightness)) return kSecondsColumns;
    return fourth_field_is_iso(lines.entries) ? kHdrgenColumns : kInverseColumns;
  }
  const Column time = format == ListFormat::kSeconds ? Column::kSeconds : Column::kInverseSeconds;
  if (lines.header && std::find(lines.header->begin(), lines.header->end(), time) != lines.header->end()) {
    return completed(*lines.header);
  }
  if (format == ListFormat::kSeconds) return kSecondsColumns;
  return format == ListFormat::kHdrgen ? kHdrgenColumns : kInverseColumns;
}

ListedExposure exposure_from(const Line& line, const Columns& columns, const std::string& list) {
  if (line.values.size() > columns.size()) {
    refuse(list, line.number,
           fmt::format("{} numbers after the name, at most {} are understood; see --list-format", line.values.size(),
                       columns.size()));
  }
  ListedExposure listed{line.name, {}};
  Exposure& e = listed.exposure;
  const auto positive = [&](double value, const char* what) {
    if (!(std::isfinite(value) && value > 0))
      refuse(list, line.number, fmt::format("{} {} must be positive", what, value));
    return value;
  };
  for (std::size_t i = 0; i < line.values.size(); ++i) {
    const double value = line.values[i];
    if (!std::isfinite(value)) refuse(list, line.number, fmt::format("{} is not a finite number", value));
    switch (columns[i]) {
      case Column::kSeconds:
        e.seconds = positive(value, "exposure time");
        break;
      case Column::kInverseSeconds:
        e.seconds = 1 / positive(value, "shutter speed");
        break;
      case Column::kFNumber:
        e.f_number = positive(value, "f-number");
        break;
      case Column::kIso:
        e.iso = positive(value, "ISO");
        break;
      case Column::kGain:
        e.iso = 100 * std::exp2(value / 3);
        break;  // 3 dB double the exposure
      case Column::kNdStops:
        e.nd_stops = value;
        break;
      case Column::kIgnored:
        break;
    }
  }
  if (!e.seconds) refuse(list, line.number, "no exposure time");
  return listed;
}

}  // namespace

std::vector<ListedExposure> parse_exposure_list(const std::string& text, const std::string& list_name,
                                                ListFormat format,
                                                const std::vector<std::optional<double>>& brightness) {
  const Lines lines = lines_from(text, list_name);
  const Columns columns = columns_of(lines, format, brightness);
  std::vector<ListedExposure> listed;
  for (const Line& line : lines.entries) listed.push_back(exposure_from(line, columns, list_name));
  return listed;
}

std::optional<ListFormat> list_format_from_name(const std::string& name) {
  if (name == "auto") return ListFormat::kAuto;
  if (name == "seconds") return ListFormat::kSeconds;
  if (name == "inverse") return ListFormat::kInverse;
  if (name == "hdrgen") return ListFormat::kHdrgen;
  return std::nullopt;
}

std::string text_from_seconds(double seconds) {
  const double inverse = std::round(1 / seconds);
  if (inverse >= 3 && std::abs(inverse * seconds - 1) < 0.002) return fmt::format("1/{} s", inverse);
  return fmt::format("{:.4g} s", seconds);
}

}  // namespace hdr
