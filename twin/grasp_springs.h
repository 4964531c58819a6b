// SPDX-License-Identifier: Apache-2.0
// The springs of controllers that let go and take hold. Where a controller is released, its springs
// have no stiffness and no dashpot. One that takes hold within a motion takes the body as it is
// then: its springs are relaxed at that moment, with rest lengths
//   L_e = |x_c - x_i|
// of where controllers and nodes are then (of a recording: as measured). These lengths are part of
// the state. They stand behind the effects' internal variables, eight
// to a record, and are 0 until then: the spring has the length of the system.
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
  // the kernel's order. The lengths stand in a state from `first_record` on.
  GraspSprings(const SpringMassSystem& system, const ControllerMask& late,
               const SpringBlocks<Real>& blocks, int first_record);

  bool has_late() const { return lengths_ > 0; }
  int records() const { return (lengths_ + kRecordSize - 1) / kRecordSize; }

  // Controllers take hold: sets the lengths of their springs.
  void Attach(const Attachment& attachment, State* state) const;
  // Gives a level that has the system's springs the lengths, and opens what is released.
  void Apply(const ControllerMask& released, const State& state, LevelStep<Real>* step) const;
  // Sets their entries of all springs' rest lengths, (springs), m.
  void ReadLengths(const State& state, Eigen::VectorXd* rest_length) const;
  // Keeps the lengths through a frame.
  void CopyLengths(const State& from, State* to) const;

  // Takes out of a gradient with respect to a level so changed what is none with respect to the
  // system: springs that were not there, lengths of the state.
  void ApplyAdjoint(const ControllerMask& released, const State& state,
                    SystemGradient* gradient) const;

 private:
  struct Spring {
    int index, node, controller;
    int slot;         // in the kernel's order
    int length = -1;  // which of the lengths in the state; -1: none, its controller is not late
  };

  static bool IsSet(const Spring& spring, const Real* lengths) {
    return spring.length >= 0 && lengths[spring.length] > 0;
  }
  Real* Lengths(State* state) const { return Internal(state, first_record_); }
  const Real* Lengths(const State& state) const { return Internal(state, first_record_); }

  int nodes_, first_record_;
  int lengths_ = 0;
  std::vector<Spring> springs_;  // of all controllers
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_GRASP_SPRINGS_H_
