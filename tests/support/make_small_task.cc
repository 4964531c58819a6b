// SPDX-License-Identifier: Apache-2.0
// For tests in Python: copies the small task to a folder. make_small_task FOLDER
#include <cstdio>
#include <filesystem>

#include "tests/support/small_task.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const physpring::SmallTask task;
  task.WriteActions(0.1, 15);
  std::filesystem::copy(task.path(), argv[1]);
  return 0;
}
