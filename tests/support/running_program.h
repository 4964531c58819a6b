// SPDX-License-Identifier: Apache-2.0
// The built program `physpring`, while it runs.
#ifndef PHYSPRING_TESTS_SUPPORT_RUNNING_PROGRAM_H_
#define PHYSPRING_TESTS_SUPPORT_RUNNING_PROGRAM_H_

#include <sys/types.h>

#include <string>
#include <vector>

namespace physpring {

class RunningProgram {
 public:
  // Starts it; what it prints goes to `output` (a file).
  RunningProgram(const std::vector<std::string>& arguments, const std::string& output);
  ~RunningProgram();  // kills it
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  void Signal(int signal) const;

  // Waits for its end. The exit status, or -1 if a signal ended it.
  int Wait();

 private:
  pid_t process_;
  bool ended_ = false;
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_RUNNING_PROGRAM_H_
