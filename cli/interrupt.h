// SPDX-License-Identifier: Apache-2.0
// Ctrl-C (SIGINT) and SIGTERM are taken as a wish to stop soon. A second one ends the program at
// once.
#ifndef PHYSPRING_CLI_INTERRUPT_H_
#define PHYSPRING_CLI_INTERRUPT_H_

#include <csignal>

#include "twin/stop_request.h"

namespace physpring {

// Thrown by a command that stopped early because of a signal and has said so: the program ends with
// status 128 + signal, as is usual.
struct Interrupted {
  int signal;
};

// While it lives, the first signal is noted, and libraries are asked to stop (twin/stop_request.h):
// what they work on throws Stopped. Only one may live at a time.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  // The signal that came, or 0.
  int signal() const;

 private:
  struct sigaction old_interrupt_, old_terminate_;
};

// Says that the command stopped and nothing was written. Throws Interrupted.
[[noreturn]] void StopWithoutOutput(const InterruptWatch& watch);

// What `work` returns, which writes nothing: where a signal stops it, ends by StopWithoutOutput.
template <class Work>
auto UnlessStopped(const Work& work) {
  const InterruptWatch watch;
  try {
    return work();
  } catch (const Stopped&) {
    StopWithoutOutput(watch);
  }
}

}  // namespace physpring

#endif  // PHYSPRING_CLI_INTERRUPT_H_
