#pragma once
// Wall clock and CPU seconds, repeated: the least is what the work needs, the median what it takes.
#include <string>
#include <vector>

namespace hdr::bench {

struct Seconds {
  double wall = 0, cpu = 0;
};

/// Of this process, all threads, and of the children it has waited for.
class Stopwatch {
 public:
  Stopwatch();
  Seconds elapsed() const;

 private:
  Seconds start_;
};

/// Runs of one piece of work.
class Runs {
 public:
  template <class Work>
  decltype(auto) time(Work&& work) {
    const Recorder recorder(*this);
    return work();
  }
  std::size_t count() const { return runs_.size(); }
  Seconds least() const;
  Seconds median() const;

 private:
  struct Recorder {
    explicit Recorder(Runs& all) : runs(all) {}
    ~Recorder() { runs.runs_.push_back(watch.elapsed()); }
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;
    Runs& runs;
    Stopwatch watch;
  };
  std::vector<Seconds> runs_;
};

}  // namespace hdr::bench
