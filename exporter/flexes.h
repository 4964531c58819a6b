// SPDX-License-Identifier: Apache-2.0
// Springs as edges of 1-D flexes. A flex has one stiffness and one damping, and the rest lengths of
// its edges are their lengths in the reference configuration: so springs are grouped by stiffness,
// and what is lost is told. MuJoCo lets no elastic flex touch a mocap body; the springs of
// controllers stay tendons.
#ifndef PHYSPRING_EXPORTER_FLEXES_H_
#define PHYSPRING_EXPORTER_FLEXES_H_

#include <vector>

#include "exporter/level_plan.h"
#include "exporter/xml.h"

namespace physpring {

struct FlexGroup {
  std::vector<int> springs;
  double stiffness = 0;  // N/m: the geometric mean
  double dashpot = 0;    // N s/m: the mean
};

// By how much the edges differ from the springs that they stand for.
struct FlexRounding {
  double stiffness_mean = 0, stiffness_max = 0;  // relative
  double dashpot_mean = 0, dashpot_max = 0;      // N s/m
  double rest_length_max = 0;                    // m
};

struct FlexGroups {
  std::vector<FlexGroup> groups;
  std::vector<int> tendons;  // springs that no flex can hold
  FlexRounding rounding;
};

// Groups by k-means of log stiffness, at most `count` (> 0) groups, none empty; springs without
// stiffness count as the softest ones.
FlexGroups GroupSprings(const SpringMassSystem& system, int count);

void AddFlexes(const LevelPlan& plan, const FlexGroups& flexes, XmlElement* mujoco);

}  // namespace physpring

#endif  // PHYSPRING_EXPORTER_FLEXES_H_
