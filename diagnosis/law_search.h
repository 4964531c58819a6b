// SPDX-License-Identifier: Apache-2.0
// The search for a law that is not in the list of effects: a sum of few terms of a library
// (twin/effects/custom.cc), each what it acts on times a course in time. A term's coefficients
// enter the forces linearly, so rollouts with a little of each give the response of the motion to
// all of them. The term that takes most of what is left, beyond what the body could take as well,
// comes next (orthogonal matching pursuit). Each is then fitted together with the body.
//   Pati, Rezaiifar, Krishnaprasad, Orthogonal matching pursuit, Asilomar 1993;
//   Brunton, Proctor, Kutz, Discovering governing equations from data, PNAS 2016 (the library).
#ifndef PHYSPRING_DIAGNOSIS_LAW_SEARCH_H_
#define PHYSPRING_DIAGNOSIS_LAW_SEARCH_H_

#include <optional>

#include "diagnosis/inquiry.h"

namespace physpring {

struct Law {
  Verdict verdict;
  int terms;  // the last effects of the verdict
};

// Terms beside what `without` has that together predict held-out frames with at most half of its
// error above noise; nothing if there are none. They are fitted from `from`, and chosen by the
// frames to fit. `stage`: the share of the work.
std::optional<Law> FindLaw(const Inquiry& inquiry, const Verdict& without, const Descent& from,
                           const WorkShare& stage);

}  // namespace physpring

#endif  // PHYSPRING_DIAGNOSIS_LAW_SEARCH_H_
