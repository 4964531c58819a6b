// SPDX-License-Identifier: Apache-2.0
#include "rollout/mujoco_log.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <csetjmp>

#include "twin/error.h"

namespace physpring {
namespace {

// What MuJoCo said in this thread since CatchMujoco was entered.
struct Messages {
  std::vector<std::string> warnings;
  std::string error;
  std::jmp_buf recovery;
};

thread_local Messages* messages = nullptr;
mjfLogHandler next_handler = nullptr;  // gets messages outside CatchMujoco

void HandleMessage(const mjLogMessage* message) {
  if (!messages) {
    next_handler(message);
  } else if (message->level == mjLOG_WARNING) {
    messages->warnings.push_back(OneLine(message->subject));
  } else if (message->level == mjLOG_ERROR) {
    messages->error = OneLine(message->subject);
    std::longjmp(messages->recovery, 1);  // an error handler must not return
  }
}

// Returns false if `call` was left at an error.
bool RunToEnd(const std::function<void()>& call, Messages* into) {
  if (setjmp(into->recovery) != 0) return false;
  call();
  return true;
}

}  // namespace

std::vector<std::string> CatchMujoco(const std::function<void()>& call) {
  // once for the process: a handler per call would race between threads
  static const bool installed = [] {
    next_handler = mju_setLogHandler(HandleMessage);
    return true;
  }();
  static_cast<void>(installed);

  Messages caught;
  Messages* const outer = messages;
  messages = &caught;
  const bool ended = RunToEnd(call, &caught);
  messages = outer;
  if (!ended) throw Error("MuJoCo: " + caught.error);
  return caught.warnings;
}

void CatchMujoco(const std::string& where, const std::function<void()>& call,
                 std::vector<std::string>* warnings) {
  for (const std::string& warning : CatchMujoco(call)) {
    warnings->push_back(fmt::format("{}: {}", where, warning));
  }
}

std::string OneLine(const std::string& message) {
  std::string line;
  bool pending = false;  // a line break not yet written
  for (const char c : message) {
    if (c == '\n' || c == '\r') {
      pending = !line.empty();
      continue;
    }
    if (pending) line += "; ";
    pending = false;
    line += c;
  }
  return line;
}

}  // namespace physpring
