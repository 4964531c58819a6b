// SPDX-License-Identifier: Apache-2.0
#include "tests/support/program.h"

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

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
  const auto lines = std::count(result.errors.begin(), result.errors.end(), '\n');
  return result.status == 1 && result.output.empty() && lines == 1 &&
         result.errors.starts_with("physpring: ") && result.errors.find(part) != std::string::npos;
}

}  // namespace physpring
