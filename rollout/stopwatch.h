// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_ROLLOUT_STOPWATCH_H_
#define PHYSPRING_ROLLOUT_STOPWATCH_H_

#include <chrono>

namespace physpring {

// Adds the time of its life to a sum, s.
class Stopwatch {
 public:
  explicit Stopwatch(double* sum) : sum_(sum) {}
  ~Stopwatch() { *sum_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double* sum_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_STOPWATCH_H_
