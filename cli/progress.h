// SPDX-License-Identifier: Apache-2.0
// Shows on stderr how far long work is: on a terminal as a bar with the time left, else as a plain
// line now and then.
#ifndef PHYSPRING_CLI_PROGRESS_H_
#define PHYSPRING_CLI_PROGRESS_H_

#include <chrono>
#include <string>

namespace physpring {

// "0.3 s", "12 s", "3 min 20 s", "2 h 5 min".
std::string FormatDuration(double seconds);

// "[####......]  42 %, 3 min 20 s left, STATUS", cut to `width` columns; without the time while it
// is not known (`seconds_left` < 0), without the bar if `width` is 0.
std::string FormatProgress(double share, double seconds_left, const std::string& status, int width);

class Progress {
 public:
  // The work is at `share` (0 to 1) now.
  explicit Progress(double share);
  ~Progress();  // ends the bar's line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Shows how far the work is if it last did so long enough ago. The time left follows from the
  // pace of the work since the start.
  void Show(double share, const std::string& status);

  // Says something in a line of its own.
  void Say(const std::string& line) const;

  double seconds() const;                  // since it was made
  double SecondsLeft(double share) const;  // below 0 while that is not known

 private:
  using Clock = std::chrono::steady_clock;

  bool terminal_;
  double start_share_;
  Clock::time_point start_ = Clock::now(), shown_ = start_;
  bool drawn_ = false;
};

}  // namespace physpring

#endif  // PHYSPRING_CLI_PROGRESS_H_
