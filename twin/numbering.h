// SPDX-License-Identifier: Apache-2.0
// Whether two files number the particles and controllers of one object alike. If they do not,
// neighbours of the one are far apart in the other.
#ifndef PHYSPRING_TWIN_NUMBERING_H_
#define PHYSPRING_TWIN_NUMBERING_H_

#include <string>

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// What is odd about the numbers in `recording`, against those in `first` or in `twin`, in words;
// empty if nothing is. Both are of the same numbers of points, interior particles and controllers.
std::string OddNumbering(const Recording& first, const Recording& recording);
std::string OddNumbering(const Twin& twin, const Recording& recording);

// Adds it to the warnings of `recording`, "WHERE: ...".
template <class Known>  // Recording or Twin
void WarnOfOddNumbering(const Known& known, const std::string& where, Recording* recording) {
  const std::string odd = OddNumbering(known, *recording);
  if (!odd.empty()) recording->warnings.push_back(where + ": " + odd);
}

}  // namespace physpring

#endif  // PHYSPRING_TWIN_NUMBERING_H_
