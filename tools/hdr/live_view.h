#pragma once
// What a camera sees, as a line of text.
#include <string>

#include "capture/appearance.h"
#include "capture/frame.h"

namespace hdr::tools {

/// "▁▂▅█▇▃▁          ▁  clipped 0.3 %  dark 2 %  1/60 s": how often codes occur, from black to white in `bars` steps.
/// Heights go as the square root, so that rare codes are seen; a step that holds anything has a bar.
std::string histogram_line(const Appearance& appearance, const ExposureSetting& setting, int bars = 48);

/// Shows frames in place, on a terminal; where stderr is none (or `silent`) there is nothing to see.
class LiveView {
 public:
  explicit LiveView(bool silent);
  ~LiveView() { clear(); }
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  bool on() const { return on_; }
  void show(const Frame& frame);
  void clear();  ///< before other lines are printed

 private:
  bool on_, drawn_ = false;
};

}  // namespace hdr::tools
