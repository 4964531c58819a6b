// SPDX-License-Identifier: Apache-2.0
// A twin in clouds of its object that have no points: where its particles are in frame 0.
#ifndef PHYSPRING_REGISTRATION_PLACED_TWIN_H_
#define PHYSPRING_REGISTRATION_PLACED_TWIN_H_

#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

// The twin's object in its reference configuration, at rest for one frame.
Recording ReferenceOf(const Twin& twin);

// The clouds' recording with the twin's points, known in frame 0 alone, and its interior particles:
// carried there as CarryOver does it (followed_body.h). Throws Error as that does.
Recording PlaceTwin(const Twin& twin, const Recording& clouds);

}  // namespace physpring

#endif  // PHYSPRING_REGISTRATION_PLACED_TWIN_H_
