// SPDX-License-Identifier: Apache-2.0
// A reduction that draws one assignment of a level in one step. Nothing is learned for it.
#ifndef PHYSPRING_TRAINER_REDUCTION_DRAWN_REDUCTION_H_
#define PHYSPRING_TRAINER_REDUCTION_DRAWN_REDUCTION_H_

#include <cstdint>

#include "trainer/reduction/clusters.h"
#include "trainer/reduction/reduction.h"
#include "twin/spring_mass_system.h"

namespace physpring {

class DrawnReduction : public Reduction {
 public:
  Reduced Reduce(const ReductionTask& task, const Work& work) const override;

 private:
  // Of a system to `nodes` clusters (as many as ClusterBudget allows); the same for the same seed.
  virtual Assignment Draw(const SpringMassSystem& system, int nodes, std::uint64_t seed) const = 0;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_REDUCTION_DRAWN_REDUCTION_H_
