// SPDX-License-Identifier: Apache-2.0
// One sub-step of several levels side by side, one in each lane: LevelStep::Advance, with the same
// bits. Springs, drag and the ground go through all lanes at once. Laws of effects, and contacts
// with anything else, take one lane after the other.
#ifndef PHYSPRING_TWIN_LANE_STEP_H_
#define PHYSPRING_TWIN_LANE_STEP_H_

#include <algorithm>
#include <cstddef>
#include <vector>

#include "twin/lane_kernel.h"
#include "twin/level_step.h"

namespace physpring {

// Numbers of several lanes side by side, 0 at first; aligned for each kernel.
template <class Real>
class LaneArray {
 public:
  LaneArray(int numbers, int lanes)
      : lines_(static_cast<std::size_t>(numbers) * lanes / kInLine + 1) {}

  Real* data() { return lines_.data()->numbers; }
  const Real* data() const { return lines_.data()->numbers; }
  void Clear() { std::fill(lines_.begin(), lines_.end(), Line{}); }

 private:
  static constexpr std::size_t kInLine = 64 / sizeof(Real);
  struct alignas(64) Line {
    Real numbers[kInLine] = {};
  };
  std::vector<Line> lines_;
};

// A lane that moves, in a sub-step. The lane's own states hold its controllers and internal
// variables; where its nodes are stands side by side with the other lanes.
template <class Real>
struct LaneNow {
  int lane;
  LevelSubstep<Real> now;
  NodeStates<Real>*state, *next;
};

template <class Real>
class LaneStep {
 public:
  using State = NodeStates<Real>;

  // One level and the numbers of its sub-step for each lane, at most kernel.lanes. They have the
  // same topology, effects, sub-step and ground. The levels must outlive this.
  LaneStep(const std::vector<const LevelStep<Real>*>& levels,
           const std::vector<NodeView<Real>>& nodes, const LaneKernel<Real>& kernel);

  // The records `first` to `first + count` of the lanes' own states, to side by side and back. A
  // lane without a state (null) is 0.
  void Interleave(const std::vector<State*>& states, int first, int count, Real* side_by_side);
  void Separate(const Real* side_by_side, int first, int count, const std::vector<State*>& states);

  // Sets the nodes of `next` and the internal variables of the lanes' own next states.
  void Advance(const std::vector<LaneNow<Real>>& lanes, const Real* state, Real* next);

 private:
  using Lanes = std::vector<LaneNow<Real>>;

  void SetParameters(const std::vector<NodeView<Real>>& nodes);
  void SeparateNodes(const Lanes& lanes, const Real* side_by_side,
                     NodeStates<Real>* LaneNow<Real>::*of);
  const Real* AddTensions(const Lanes& lanes, const Real* state);
  void AddNodeForces(const Lanes& lanes);
  // DashpotStages::Apply of all lanes.
  void ApplyDashpotStages(const LaneSprings<Real>& springs);
  void ApplyContacts(const Lanes& lanes, const Real* state, Real* next);
  void ApplyAllContacts(const Lanes& lanes, const Real* state, Real* next);
  void HitGround(const Real* state, Real* next) const;

  const LevelStep<Real>& level() const { return *levels_[0]; }
  bool HasStages() const { return level().dashpot_stages().count() > 1; }
  int Staged(int numbers) const { return HasStages() ? numbers : 0; }
  LaneNodes<Real> Nodes() const {
    return {nodes_, h_, h_over_mass_.data(), decay_.data(), kick_.data()};
  }

  std::vector<const LevelStep<Real>*> levels_;
  const LaneKernel<Real>& kernel_;
  int nodes_, springs_;
  Real h_;
  bool needs_nodes_;  // the effects: where they are in the lanes' own states
  LaneArray<Real> h_over_mass_, decay_, kick_, parameters_, radius_;
  LaneArray<Real> restitution_, friction_, pyramidal_;
  // what a sub-step works in
  LaneArray<Real> force_, length_, rate_, tension_;
  // of dashpots in stages: n, R_j, D R_j, and E_j-1, E_j, E_j+1
  LaneArray<Real> direction_, velocity_, staged_, before_, effect_, after_;
  std::vector<EffectBuffers<Real>> effects_;                // (lanes)
  std::vector<typename LevelStep<Real>::Impacts> impacts_;  // (lanes)
  std::vector<State*> own_;                                 // (lanes)
  std::vector<Real*> rows_;                                 // (lanes)
  std::vector<Real> spare_;                                 // the row of a lane without one
};

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LANE_STEP_H_
