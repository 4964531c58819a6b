// SPDX-License-Identifier: Apache-2.0
// The springs of controllers that let go and take hold. Where a controller is released, its springs
// have no stiffness and no dashpot, and nothing bends or twists about it. One that takes hold
// within a motion takes the body as it is then (of a recording: as measured). At that moment its
// springs are as long or as short of their rest lengths L as in the reference configuration X. So
// the rest lengths become
//   L_e + s_e,   s_e = |x_c - x_i| - |X_c - X_i|
// These shifts s are part of the state. They stand behind the effects' internal variables, eight to
// a record, and are 0 at first.
#ifndef PHYSPRING_TWIN_GRASP_SPRINGS_H_
#define PHYSPRING_TWIN_GRASP_SPRINGS_H_

#include <vector>

#include "twin/controller_mask.h"
#include "twin/level_step.h"
#include "twin/node_state.h"
#include "twin/points.h"
#include "twin/spring_mass_system.h"
#include "twin/system_gradient.h"

namespace physpring {

// Controllers that take hold, and where controllers and nodes are at that moment.
struct Attachment {
  ControllerMask attached;
  Points controllers, nodes;  // 3 x controllers, 3 x nodes, m; of any size if none takes hold

  bool any() const { return !attached.empty(); }
};

template <class Real>
class GraspSprings {
 public:
  using State = NodeStates<Real>;

  // `late`: the controllers that may take hold within a motion. `blocks`: the system's springs in
  // the kernel's order. The shifts stand in a state from `first_record` on.
  GraspSprings(const SpringMassSystem& system, const ControllerMask& late,
               const SpringBlocks<Real>& blocks, int first_record);

  bool has_late() const { return shifts_ > 0; }
  int records() const { return (shifts_ + kRecordSize - 1) / kRecordSize; }

  // Controllers take hold: sets the shifts of their springs.
  void Attach(const Attachment& attachment, State* state) const;
  // Changes a level that has the system's springs: adds the shifts, and opens what is released.
  void Apply(const ControllerMask& released, const State& state, LevelStep<Real>* step) const;
  // Takes out of a gradient with respect to a level so changed what belongs to opened springs.
  void ApplyAdjoint(const ControllerMask& released, SystemGradient* gradient) const;
  // Adds the shifts to all springs' rest lengths, (springs), m.
  void AddShifts(const State& state, Eigen::VectorXd* rest_length) const;
  // Keeps the shifts through a frame.
  void CopyShifts(const State& from, State* to) const;

 private:
  struct Spring {
    int index, node, controller;
    int slot;          // in the kernel's order
    double reference;  // its length in the reference configuration, m
    int shift = -1;    // which of the shifts in the state; -1: none, its controller is not late
  };

  Real* Shifts(State* state) const { return Internal(state, first_record_); }
  const Real* Shifts(const State& state) const { return Internal(state, first_record_); }

  int first_record_;
  int shifts_ = 0;
  std::vector<Spring> springs_;  // of all controllers, in the order of the system
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_GRASP_SPRINGS_H_
