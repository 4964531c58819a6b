// SPDX-License-Identifier: Apache-2.0
// The reductions there are. To add one: its file, and its line in registry.cc.
#ifndef PHYSPRING_TRAINER_REDUCTION_REGISTRY_H_
#define PHYSPRING_TRAINER_REDUCTION_REGISTRY_H_

#include <memory>
#include <string>
#include <vector>

#include "trainer/reduction/reduction.h"

namespace physpring {

// All reductions, in the order of the list.
const std::vector<std::unique_ptr<Reduction>>& AllReductions();

// The reduction of that name; throws Error if there is none.
const Reduction& GetReduction(const std::string& name);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_REGISTRY_H_
