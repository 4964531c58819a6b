// SPDX-License-Identifier: Apache-2.0
// A task in a temporary folder: the small twin's block lies on a floor, a box on a weld pushes it,
// and success is to have it behind a line.
#ifndef PHYSPRING_TESTS_SUPPORT_SMALL_TASK_H_
#define PHYSPRING_TESTS_SUPPORT_SMALL_TASK_H_

#include <string>

#include "tests/support/temporary_folder.h"

namespace physpring {

class SmallTask {
 public:
  SmallTask();  // with three levels

  std::string path() const { return folder_.File("push"); }
  std::string File(const std::string& name) const { return folder_.File("push/" + name); }

  // task.json with `from` replaced by `to`.
  void Change(const std::string& from, const std::string& to) const;

  // Writes actions that push the block by `way` [m] in `frames` frames; returns the file.
  std::string WriteActions(double way, int frames) const;

 private:
  TemporaryFolder folder_;
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_SMALL_TASK_H_
