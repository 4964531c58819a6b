// SPDX-License-Identifier: Apache-2.0
#include "trainer/projection/assignment.h"

#include <algorithm>
#include <map>

namespace physpring {

Assignment Renumber(const Assignment& assignment) {
  std::map<int, int> number;
  Assignment renumbered;
  for (int cluster : assignment) {
    renumbered.push_back(
        number.try_emplace(cluster, static_cast<int>(number.size())).first->second);
  }
  return renumbered;
}

int CountClusters(const Assignment& assignment) {
  return 1 + *std::max_element(assignment.begin(), assignment.end());
}

}  // namespace physpring
