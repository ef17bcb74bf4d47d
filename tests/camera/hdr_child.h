#pragma once
// The hdr command as a child process. Forked where that is possible: loading its libraries takes seconds on an emulated
// processor, and is done already in the test program. Those of libcamera do not survive a fork: then it is started.
#include <sys/types.h>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "tests/support/support.h"

namespace hdr::test {

class HdrChild {
 public:
  /// user: who runs it; 0 is root.
  explicit HdrChild(std::vector<std::string> arguments, uid_t user = 0);
  /// Kills what still runs.
  ~HdrChild();
  HdrChild(const HdrChild&) = delete;
  HdrChild& operator=(const HdrChild&) = delete;

  void send(int signal) const;
  /// Waits for its end; exit_code is 128 + signal when it was killed, as it is after three minutes.
  CommandResult wait();
  /// From the start to the end that wait() saw, without what loading the libraries may take.
  double seconds() const { return seconds_; }

 private:
  pid_t process_ = -1;
  std::chrono::steady_clock::time_point start_;
  double seconds_ = 0, loading_ = 0;
  ScratchDir streams_;
};

/// What `question` returns, asked in a child process: libraries that start threads do so there, and this program stays
/// one that can be forked. NaN when it fails.
double asked_in_a_child(const std::function<double()>& question);

}  // namespace hdr::test
