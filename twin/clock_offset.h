// SPDX-License-Identifier: Apache-2.0
// Points and controllers may be measured by clocks that differ by a constant offset. A training
// finds it where a recording says that there are two clocks, and the twin keeps it.
#ifndef PHYSPRING_TWIN_CLOCK_OFFSET_H_
#define PHYSPRING_TWIN_CLOCK_OFFSET_H_

#include <string>

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// Lets the controllers, and the forces at them, be `seconds` later than recorded (earlier, if
// negative). They stand still before their first frame and after their last one.
void ShiftControllers(double seconds, Recording* recording);

// The same by the twin's offset, if it has one and the recording has two clocks.
void UseClockOf(const Twin& twin, Recording* recording);

// A recording that a twin is used on: read (ReadRecording), by the twin's clock.
Recording ReadRecordingFor(const Twin& twin, const std::string& path);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_CLOCK_OFFSET_H_
