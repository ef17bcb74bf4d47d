#pragma once
// One measurement: what was done with which setting, how far off the answer is, and what it cost.
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace hdr::bench {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

struct Row {
  std::string suite;    ///< "sh"
  std::string stage;    ///< one plot: "irradiance of a sunny map, 1024x512"
  std::string subject;  ///< one curve: "hdr", "hdr reference", "OpenCV AlignMTB"
  std::string knob;     ///< what is turned: "degree"; "threads" and "megapixels" are curves of scaling
  std::string label{};  ///< the setting, where it is no number: "half piz"
  double value = kUnknown;

  double error = kUnknown;  ///< of the answer, against the truth of the suite
  std::string error_name, error_unit;

  // The least of several runs, interleaved with those of the others; unknown where the answer is wrong.
  double cpu_seconds = kUnknown, median_cpu_seconds = kUnknown;
  double wall_seconds = kUnknown;
  std::string time_name{};  ///< where CPU seconds are not the point: what wall_seconds are, "by the camera's clock"
  std::int64_t peak_bytes = -1;  ///< of memory, beyond what was in use before; below 0: unknown
  double megapixels = kUnknown;
  int threads = 0;
  std::string note{};     ///< why there is no time, or what else is worth a word
  std::string setting{};  ///< how to ask the command for it: "hdr sh probe.exr --degree 2"; empty: it cannot be asked

  bool timed() const { return cpu_seconds == cpu_seconds; }
  double time() const { return time_name.empty() ? cpu_seconds : wall_seconds; }  ///< what errors are held against
  bool ours() const { return subject.rfind("hdr", 0) == 0 && subject != "hdr reference"; }
};

/// A rival that could have been measured and is not there, and how it would be.
struct Absent {
  std::string name, remedy;
};

/// Value or label, for people.
std::string text_of_value(const Row& row);

/// A line of names, then a line a row; text with commas or quotes is quoted [RFC 4180], what is unknown is empty.
std::string csv_of(const std::vector<Row>& rows);

/// Columns for a terminal, one block a stage.
std::string table_of(const std::vector<Row>& rows);

/// "1.52", "0.0314", "2.1e-08": three digits, plain where that is short.
std::string short_number(double value);
/// "350 us", "1.2 ms", "0.7 s"; "-" when unknown.
std::string short_seconds(double seconds);
std::string short_bytes(std::int64_t bytes);

}  // namespace hdr::bench
