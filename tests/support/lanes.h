// SPDX-License-Identifier: Apache-2.0
// Rollouts side by side against each of them alone.
#ifndef PHYSPRING_TESTS_SUPPORT_LANES_H_
#define PHYSPRING_TESTS_SUPPORT_LANES_H_

#include <string>
#include <vector>

#include "tests/support/targeted_rollout.h"

namespace physpring {

// "" if every lane kernel that this processor can run gives each of the rollouts, in each frame,
// the bits that it has alone, with the scalar kernel and with the fastest one, in float and in
// double; else the first difference. The rollouts are of alike systems in one environment.
std::string DifferenceSideBySide(const std::vector<TargetedRollout>& rollouts);

// Whether this processor can run any lane kernel.
bool HasLanes();

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_LANES_H_
