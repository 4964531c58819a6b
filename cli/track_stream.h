// SPDX-License-Identifier: Apache-2.0
// physpring track --stream: frames on standard input, states on standard output, a line of JSON
// each.
#ifndef PHYSPRING_CLI_TRACK_STREAM_H_
#define PHYSPRING_CLI_TRACK_STREAM_H_

#include <string>

#include "tracker/live_tracker.h"

namespace physpring {

// Follows the object of the twin in that file until the input ends. options.fps of 0 is the twin's.
// Throws Error, one line that says which one, where a line is not what docs/track.md says.
void TrackStream(const std::string& twin, LiveOptions options);

}  // namespace physpring

#endif  // PHYSPRING_CLI_TRACK_STREAM_H_
