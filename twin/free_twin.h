// SPDX-License-Identifier: Apache-2.0
// A twin that nothing holds: for scenes where it lies free and grippers touch it.
#ifndef PHYSPRING_TWIN_FREE_TWIN_H_
#define PHYSPRING_TWIN_FREE_TWIN_H_

#include "twin/twin.h"

namespace physpring {

// `twin` without its controllers, the springs that join them to nodes, its posterior and what
// training left. The springs that remain keep their order. Throws Error if a level has no spring
// between nodes.
Twin WithoutControllers(Twin twin);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_FREE_TWIN_H_
