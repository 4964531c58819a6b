// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TRAINER_BODIES_SPRING_NET_H_
#define PHYSPRING_TRAINER_BODIES_SPRING_NET_H_

#include "trainer/bodies/body.h"

namespace physpring {

// Particles joined to all around them, each spring with values of its own.
const BodyKind& SpringNet();

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_BODIES_SPRING_NET_H_
