// SPDX-License-Identifier: Apache-2.0
#include "cli/interrupt.h"

#include "cli/message.h"

namespace physpring {
namespace {

// Global, because a signal handler has no other way to tell.
volatile sig_atomic_t noted_signal = 0;

void NoteSignal(int signal) {
  noted_signal = signal;
  RequestStop(true);
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  sigaction(SIGINT, &usual, nullptr);
  sigaction(SIGTERM, &usual, nullptr);
}

}  // namespace

InterruptWatch::InterruptWatch() {
  noted_signal = 0;
  RequestStop(false);
  struct sigaction note {};
  note.sa_handler = NoteSignal;
  note.sa_flags = SA_RESTART;
  sigaction(SIGINT, &note, &old_interrupt_);
  sigaction(SIGTERM, &note, &old_terminate_);
}

InterruptWatch::~InterruptWatch() {
  RequestStop(false);
  sigaction(SIGINT, &old_interrupt_, nullptr);
  sigaction(SIGTERM, &old_terminate_, nullptr);
}

int InterruptWatch::signal() const { return noted_signal; }

void StopWithoutOutput(const InterruptWatch& watch) {
  Tell("physpring: stopped; nothing was written\n");
  throw Interrupted{watch.signal()};
}

}  // namespace physpring
