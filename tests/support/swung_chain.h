// SPDX-License-Identifier: Apache-2.0
// A rod that moved as its chain (trainer/bodies/bending_chain.h) does with all factors 0.
#ifndef PHYSPRING_TESTS_SUPPORT_SWUNG_CHAIN_H_
#define PHYSPRING_TESTS_SUPPORT_SWUNG_CHAIN_H_

#include "tests/support/swung_rope.h"
#include "trainer/bodies/candidates.h"
#include "trainer/bodies/chosen_body.h"

namespace physpring {

struct SwungChain {
  explicit SwungChain(int frames) : recording(SwungRope(8, frames)) {
    recording.rod = PlainRod(Eigen::VectorXd::LinSpaced(recording.rest.cols(), 0.3, 0));
    model.body = CandidateBodies(recording, {}).back();
    model.start_substeps = 8;
    model.start = Eigen::VectorXd::Zero(model.ParametersOf(recording).size());
    model.factors = model.start;
    MoveAs(model.System(recording), model.body.controller_velocity, &recording);
  }

  // Factors with 0.3 at the entries.
  Eigen::VectorXd Off(const std::vector<int>& entries) const {
    Eigen::VectorXd off = Eigen::VectorXd::Zero(model.factors.size());
    for (int i : entries) off[i] = 0.3;
    return off;
  }

  Recording recording;
  ChosenBody model;
};

}  // namespace physpring

#endif  // PHYSPRING_TESTS_SUPPORT_SWUNG_CHAIN_H_
