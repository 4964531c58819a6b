// SPDX-License-Identifier: Apache-2.0
// A net holds more springs than the object needs: which pairs of particles are joined is not known.
// The springs of a class that a fit has made far softer than others carry nothing. What is left of
// them still bends to the one motion that was fitted, and costs as much time as true springs. In an
// irregular mesh a class may hold springs of the object and superfluous ones: the object's end at
// one length, and it takes three calls, with a fit between them, to tell it to single springs.
#ifndef PHYSPRING_TRAINER_FITS_SUPERFLUOUS_SPRINGS_H_
#define PHYSPRING_TRAINER_FITS_SUPERFLUOUS_SPRINGS_H_

#include <optional>

#include "trainer/fits/smooth_fit.h"

namespace physpring {

// The body without them, as stiff as before in all else; nothing where there are none, or where a
// node or a controller would hang on too few.
std::optional<SmoothlyFitted> WithoutSuperfluousSprings(const SmoothlyFitted& fit,
                                                        const Recording& recording,
                                                        const BodyKind& kind);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_FITS_SUPERFLUOUS_SPRINGS_H_
