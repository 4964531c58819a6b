// SPDX-License-Identifier: Apache-2.0
#include "twin/column_names.h"

#include <fmt/format.h>

namespace physpring {

std::string NameOfColumn(const Recording& recording, Eigen::Index column) {
  if (column < recording.point_count()) return fmt::format("point {}", column);
  column -= recording.point_count();
  if (column < recording.interior_count()) return fmt::format("interior particle {}", column);
  return fmt::format("controller {}", column - recording.interior_count());
}

std::string NameOfController(const Recording& recording, int controller) {
  std::string name = fmt::format("controller {}", controller);
  if (recording.held.size() == 0 || recording.held(0, controller)) return name;
  int first = 0;
  while (first < recording.held.rows() && !recording.held(first, controller)) ++first;
  return fmt::format("{}, the grasp from frame {} on,", name, first);
}

}  // namespace physpring
