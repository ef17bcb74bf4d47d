#include "tools/hdr/interrupt.h"

#include <csignal>

namespace hdr::tools {
namespace {

volatile std::sig_atomic_t noted_signal = 0;
struct sigaction old_interrupt, old_terminate;

extern "C" void note_signal(int number) {
  noted_signal = number;
}

}  // namespace

Interrupt::Interrupt() {
  noted_signal = 0;
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // without SA_RESTART: who waits for a device is woken
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &old_interrupt);
  sigaction(SIGTERM, &action, &old_terminate);
}

Interrupt::~Interrupt() {
  sigaction(SIGINT, &old_interrupt, nullptr);
  sigaction(SIGTERM, &old_terminate, nullptr);
}

bool Interrupt::noted() {
  return noted_signal != 0;
}

void Interrupt::check() {
  if (noted()) throw Interrupted("stopped by a signal; nothing was written");
}

}  // namespace hdr::tools
