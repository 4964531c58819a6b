// SPDX-License-Identifier: Apache-2.0
// A recording whose frames were measured at times of their own is brought to a fixed frame rate,
// and its controllers and forces to the same frames (resampling.h).
#ifndef PHYSPRING_TWIN_RECORDING_CLOCKS_H_
#define PHYSPRING_TWIN_RECORDING_CLOCKS_H_

#include <string>

#include "twin/npz_fields.h"
#include "twin/recording.h"

namespace physpring {

inline constexpr double kLeastFps = 0.1, kMostFps = 1e6;  // of a recording

// Reads `timestamps` and `controller_timestamps`, (T,) and (Tc,), s, where there are any. What was
// read before has the frames as measured; `fps` 0 if it is not given. Throws Error, naming the
// array, for times that do not increase, leave far greater gaps than frames, or are not those of
// the points. `path` begins warnings and notes.
void BringToOneRate(NpzFields& fields, const std::string& path, Recording* recording);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_RECORDING_CLOCKS_H_
