// SPDX-License-Identifier: Apache-2.0
#include "tests/support/program.h"

#include <sys/wait.h>

#include <cstdlib>
#include <sstream>

#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"

namespace physpring {
namespace {

// For the shell; the arguments of tests hold no quotes.
std::string InQuotes(const std::string& argument) { return " '" + argument + "'"; }

}  // namespace

ProgramResult RunProgram(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  std::string command = InQuotes(PHYSPRING_PROGRAM);
  for (const std::string& argument : arguments) command += InQuotes(argument);
  command += " >" + InQuotes(folder.File("output")) + " 2>" + InQuotes(folder.File("errors"));
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadFile(folder.File("output")),
          ReadFile(folder.File("errors"))};
}

bool FailsWith(const ProgramResult& result, const std::string& part) {
  std::istringstream lines(result.errors);
  std::string line, last;
  while (std::getline(lines, line)) {
    const bool remark = last.empty() || last.starts_with("warning: ") || last.starts_with("note: ");
    if (!remark) return false;
    last = line;
  }
  return result.status == 1 && result.output.empty() && last.starts_with("physpring: ") &&
         last.find(part) != std::string::npos;
}

}  // namespace physpring
