// SPDX-License-Identifier: Apache-2.0
// Whether clouds of points without names can be what they are taken for.
#ifndef PHYSPRING_TWIN_CHECKS_CLOUDS_H_
#define PHYSPRING_TWIN_CHECKS_CLOUDS_H_

#include <string>
#include <vector>

#include "twin/recording.h"

namespace physpring {

// Points that only fill an array up become NaN: a place where a frame has three or more of them (at
// the origin two), to the last bit, is no point in any frame if it is the origin, or so in several
// frames; else one of them is. Returns what it did, one line that begins with `where`; empty if it
// did nothing.
std::string TakeFillingAsNone(const std::string& where, std::vector<Points>* clouds);

// What is odd about the clouds of a recording without points, a line each: frames without any,
// or with the one before again, units, a ground above them, controllers far from them.
std::vector<std::string> FindOddClouds(const Recording& recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CHECKS_CLOUDS_H_
