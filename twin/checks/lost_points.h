// SPDX-License-Identifier: Apache-2.0
// Points that a tracker lost and wrote as (0, 0, 0).
#ifndef PHYSPRING_TWIN_CHECKS_LOST_POINTS_H_
#define PHYSPRING_TWIN_CHECKS_LOST_POINTS_H_

#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

// Takes points that are exactly at the origin for a while, and far from it just before or after, as
// not seen (NaN). Returns what it did, one line that begins with `where`; empty if it did nothing.
std::string TakeZerosAsUnseen(const std::string& where, std::vector<Points>* frames);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_LOST_POINTS_H_
