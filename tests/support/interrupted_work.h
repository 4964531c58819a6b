// SPDX-License-Identifier: Apache-2.0
// Long work in tests: run to its end, or stopped and gone on with, as by a signal between two
// steps.
#ifndef PHYSPRING_TESTS_SUPPORT_INTERRUPTED_WORK_H_
#define PHYSPRING_TESTS_SUPPORT_INTERRUPTED_WORK_H_

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "trainer/journal/work.h"

namespace physpring {

inline Work WorkOf(Journal* journal) { return {journal, PieceKey("test")}; }

// What the steps of a work were.
struct WorkLog {
  int steps = 0;
  std::vector<double> shares;        // of the work that was done after each
  std::map<std::string, int> parts;  // steps by the name of their part
  std::vector<Twin> reached;
};

template <class Run>  // Result run(const Work&)
auto RunLogged(const Run& run, WorkLog* log) {
  Journal journal;
  journal.kept = [log](const Journal::Piece& piece) {
    ++log->steps;
    log->shares.push_back(piece.share);
    ++log->parts[piece.name];
  };
  journal.reached = [log](const Twin& twin) { log->reached.push_back(twin); };
  return run(WorkOf(&journal));
}

template <class Run>
auto RunToTheEnd(const Run& run) {
  Journal journal;
  return run(WorkOf(&journal));
}

// Stops after every `interval` steps, and goes on with what was saved then. `stops` counts.
template <class Run>
auto RunStopped(const Run& run, int interval, int* stops) {
  struct Stop {};
  Journal::Arrays saved = Journal().Save();
  for (*stops = 0;; ++*stops) {
    Journal journal;
    journal.Load(saved);
    int steps = 0;
    journal.progress = [&](double, const std::string&) {
      if (steps++ == interval) throw Stop();
    };
    try {
      return run(WorkOf(&journal));
    } catch (const Stop&) {
      saved = journal.Save();
    }
  }
}

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_INTERRUPTED_WORK_H_
