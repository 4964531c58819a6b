// SPDX-License-Identifier: Apache-2.0
// What counts as success, judged on the particles of level 0, whatever level is simulated: counts
// of springs and particles then mean the same at every level.
//
// | rule              | met in a frame when                                                       |
// |-------------------|---------------------------------------------------------------------------|
// | springs_through   | at least `springs` springs cross each of two opposite faces of a box      |
// | particles_inside  | at least `fraction` of the particles are in a box                         |
// | near_target       | the mean squared distance to where the particles should be is at most ... |
// | pairs_close       | the mean distance of pairs of particles is at most `distance`             |
#ifndef PHYSPRING_ROLLOUT_SUCCESS_RULE_H_
#define PHYSPRING_ROLLOUT_SUCCESS_RULE_H_

#include <memory>
#include <vector>

#include "rollout/task.h"
#include "twin/points.h"

namespace physpring {

class SuccessRule {
 public:
  struct Verdict {
    bool met = false;
    double value = 0;  // what was compared, in the rule's own unit: for records and plots
  };

  virtual ~SuccessRule() = default;

  // `particles`: 3 x level-0 particles, m, in the frame of SuccessOptions::body.
  virtual Verdict Judge(const Points& particles) const = 0;
};

// Throws Error for a rule that is not known or whose numbers make no sense.
std::unique_ptr<SuccessRule> MakeSuccessRule(const Task& task);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_SUCCESS_RULE_H_
