// SPDX-License-Identifier: Apache-2.0
// Runs the built program `physpring` as a user would.
#ifndef PHYSPRING_TESTS_SUPPORT_PROGRAM_H_
#define PHYSPRING_TESTS_SUPPORT_PROGRAM_H_

#include <string>
#include <vector>

namespace physpring {

struct ProgramResult {
  int status = -1;     // exit status; -1: ended by a signal
  std::string output;  // on standard output
  std::string errors;  // on standard error
};

// Runs it with these arguments, and waits.
ProgramResult RunProgram(const std::vector<std::string>& arguments);

// Whether `result` is what a failure has to be: status 1, nothing on standard output, and one line
// "physpring: ..." on standard error that holds `part`. Warnings and notes may stand before it.
bool FailsWith(const ProgramResult& result, const std::string& part);

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_PROGRAM_H_
