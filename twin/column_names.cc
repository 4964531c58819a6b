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

}  // namespace physpring
