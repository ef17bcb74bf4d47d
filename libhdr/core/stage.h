#pragma once
// What was done, how long it took, and what was not needed. Every command reports its stages.
#include <string>
#include <vector>

namespace hdr {

struct Stage {
  std::string name;
  double seconds = 0;      ///< wall clock
  double cpu_seconds = 0;  ///< of all threads of the process
  std::string skipped;     ///< "reason, bound on the error"; empty when nothing was skipped
};

/// Time since it was made: of the wall clock, and of all threads of the process.
class Stopwatch {
 public:
  Stopwatch();
  double seconds() const;
  double cpu_seconds() const;

 private:
  double wall_, cpu_;
};

/// Times the stages of one command: `clock.run("merge", [&] { ... })` appends a Stage and returns the result.
class StageClock {
 public:
  template <class Work>
  decltype(auto) run(const std::string& name, Work&& work) {
    const Timing timing(*this, name);
    return work();
  }
  /// Says of the stage finished last (or of the running one) what was skipped and why that was safe.
  void skipped(const std::string& reason);
  /// Two stages that ran hand in hand: appends a stage with a part of the time of the one finished last.
  void split(const std::string& name, double seconds, double cpu_seconds);
  const std::vector<Stage>& stages() const { return stages_; }

 private:
  class Timing {
   public:
    Timing(StageClock& clock, const std::string& name);
    ~Timing();
    Timing(const Timing&) = delete;
    Timing& operator=(const Timing&) = delete;

   private:
    StageClock& clock_;
    std::size_t index_;
    Stopwatch watch_;
  };
  std::vector<Stage> stages_;
};

}  // namespace hdr
