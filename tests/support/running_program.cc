// SPDX-License-Identifier: Apache-2.0
#include "tests/support/running_program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace physpring {

RunningProgram::RunningProgram(const std::vector<std::string>& arguments,
                               const std::string& output) {
  std::vector<std::string> words = {PHYSPRING_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  process_ = fork();
  if (process_ == 0) {
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    execv(pointers[0], pointers.data());
    _exit(127);
  }
  close(file);
}

RunningProgram::~RunningProgram() {
  if (ended_) return;
  Signal(SIGKILL);
  Wait();
}

void RunningProgram::Signal(int signal) const { kill(process_, signal); }

int RunningProgram::Wait() {
  int status = 0;
  waitpid(process_, &status, 0);
  ended_ = true;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace physpring
