#pragma once
// What a suite is given: a place for its rows, and a race that checks every answer before it takes its time.
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "tests/bench/row.h"

namespace hdr::bench {

/// A way to an answer.
struct Contender {
  Row row;                          ///< what it is and how it is set; the race fills in error, time and memory
  std::function<void()> work;       ///< what is timed; it leaves its answer where `error` finds it
  std::function<double()> error{};  ///< of the answer that is there, in row.error_unit; empty: there is nothing to ask
  double sane = std::numeric_limits<double>::infinity();  ///< beyond this, or NaN, it is no answer
};

struct BenchOptions {
  bool quick = false;
  Path probe{};  ///< a lat-long for the suites of light, in place of an invented sky
  Path scene{};  ///< a mesh for those that render, in place of spheres on a plane
};

/// A picture that a suite made, to be looked at.
struct Picture {
  std::string name, caption;
  Image<std::uint8_t> codes;  ///< 8-bit sRGB
};

class Bench {
 public:
  explicit Bench(BenchOptions options) : options_(std::move(options)) {}

  const BenchOptions& options() const { return options_; }
  bool quick() const { return options_.quick; }
  /// The one or the other.
  template <class T>
  T pick(T in_quick, T in_full) const {
    return quick() ? in_quick : in_full;
  }

  /// Runs all contenders once, with their memory, and asks for the errors. Those whose answer is sane are then timed,
  /// run by run in turn, so that what else the machine does meets all alike: as often as the time for each allows, and
  /// short work many times in a row. Work that throws becomes a row without time that says why.
  /// Returns the index of the first of their rows.
  std::size_t race(std::vector<Contender> contenders);

  /// A part of a suite. What it throws outside of a race (a bracket that cannot be made, a truth that cannot be had)
  /// becomes a row of this stage that says why, and the suite goes on with its next part.
  void attempt(const std::string& suite, const std::string& stage, const std::function<void()>& part);

  void add(Row row);
  Row& row(std::size_t index) { return rows_[index]; }
  void absent(const std::string& name, const std::string& remedy);
  void show(Picture picture) { pictures_.push_back(std::move(picture)); }

  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<Absent>& absentees() const { return absent_; }
  const std::vector<Picture>& pictures() const { return pictures_; }

 private:
  BenchOptions options_;
  std::vector<Row> rows_;
  std::vector<Absent> absent_;
  std::vector<Picture> pictures_;
};

/// 1, 2, 4 ... and all that are in use now.
std::vector<int> thread_counts();

/// The same work at several thread counts, as rows of the knob "threads". Leaves the number as it was.
void race_threads(Bench& bench, const Row& row, const std::function<void()>& work);

}  // namespace hdr::bench
