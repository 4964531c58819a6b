// SPDX-License-Identifier: Apache-2.0
// The simulator's bits are a function of its input: not of the workspace, its past, or threads.
#include <gtest/gtest.h>

#include <cstring>
#include <thread>
#include <vector>

#include "tests/support/random_system.h"
#include "tests/support/targeted_rollout.h"
#include "twin/simulator.h"

namespace physpring {
namespace {

template <class Real>
bool SameBits(const NodeStates<Real>& p, const NodeStates<Real>& q) {
  return p.size() == q.size() &&
         std::memcmp(p.data(), q.data(), p.size() * sizeof(NodeState<Real>)) == 0;
}

void ExpectSame(const SystemGradient& p, const SystemGradient& q) {
  EXPECT_EQ(p.stiffness, q.stiffness);
  EXPECT_EQ(p.rest_length, q.rest_length);
  EXPECT_EQ(p.dashpot, q.dashpot);
  EXPECT_EQ(p.mass, q.mass);
  EXPECT_EQ(p.drag, q.drag);
  EXPECT_EQ(p.gravity, q.gravity);
  EXPECT_EQ(p.contact.surface.restitution, q.contact.surface.restitution);
  EXPECT_EQ(p.contact.surface.friction, q.contact.surface.friction);
  EXPECT_EQ(p.contact.object.restitution, q.contact.object.restitution);
  EXPECT_EQ(p.contact.object.friction, q.contact.object.friction);
}

// All kinds of contact.
TargetedRollout BusyRollout() {
  TargetedRollout rollout = RandomRollout(3, 1);
  rollout.position *= 0.6;
  rollout.velocity *= 3;
  rollout.system.contact.collision_distance = 0.03;
  rollout.environment.ground = Eigen::Vector4d(0, 0, 1, -0.05);
  Geom sphere;
  sphere.radius = 0.04;
  sphere.velocity = {0.1, 0.2, 0.3};
  for (FrameInput& input : rollout.frames) input.geoms = {sphere};
  return rollout;
}

// Everything that comes out of a rollout forwards and backwards.
template <class Real>
struct Output {
  std::vector<NodeStates<Real>> states;
  std::vector<NodeStates<Real>> state_bars;
  SystemGradient gradient;
};

template <class Real>
Output<Real> Run(const Simulator<Real>& simulator, const TargetedRollout& rollout,
                 typename Simulator<Real>::Workspace* workspace) {
  Output<Real> output{{simulator.MakeState(rollout.position, rollout.velocity)},
                      {},
                      SystemGradient(rollout.system)};
  for (const FrameInput& input : rollout.frames) {
    output.states.push_back(output.states.back());
    simulator.AdvanceFrame(input, &output.states.back(), workspace);
  }
  NodeStates<Real> state_bar = simulator.MakeState(rollout.target[0], rollout.target[1]);
  for (std::size_t frame = rollout.frames.size(); frame-- > 0;) {
    simulator.AdvanceFrameAdjoint(output.states[frame], rollout.frames[frame], &state_bar,
                                  &output.gradient, workspace);
    output.state_bars.push_back(state_bar);
  }
  return output;
}

template <class Real>
void ExpectSame(const Output<Real>& p, const Output<Real>& q) {
  ASSERT_EQ(p.states.size(), q.states.size());
  for (std::size_t i = 0; i < p.states.size(); ++i) {
    EXPECT_TRUE(SameBits(p.states[i], q.states[i])) << i;
  }
  for (std::size_t i = 0; i < p.state_bars.size(); ++i) {
    EXPECT_TRUE(SameBits(p.state_bars[i], q.state_bars[i])) << i;
  }
  ExpectSame(p.gradient, q.gradient);
}

template <class Real>
class SimulatorDeterminism : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(SimulatorDeterminism, Reals);

TYPED_TEST(SimulatorDeterminism, AUsedWorkspaceIsAsGoodAsANewOne) {
  using Sim = Simulator<TypeParam>;
  const TargetedRollout rollout = BusyRollout();
  const Sim simulator(rollout.system, rollout.environment, rollout.options);
  typename Sim::Workspace fresh(simulator), used(simulator);
  TargetedRollout other = rollout;
  other.velocity *= -2;
  other.position *= 1.1;
  Run(simulator, other, &used);
  ExpectSame(Run(simulator, rollout, &fresh), Run(simulator, rollout, &used));
}

TYPED_TEST(SimulatorDeterminism, ASecondSimulatorGivesTheSame) {
  using Sim = Simulator<TypeParam>;
  const TargetedRollout rollout = BusyRollout();
  const Sim first(rollout.system, rollout.environment, rollout.options);
  const Sim second(rollout.system, rollout.environment, rollout.options);
  typename Sim::Workspace first_workspace(first), second_workspace(second);
  ExpectSame(Run(first, rollout, &first_workspace), Run(second, rollout, &second_workspace));
}

TYPED_TEST(SimulatorDeterminism, EveryKernelGivesTheSame) {
  using Sim = Simulator<TypeParam>;
  const TargetedRollout rollout = BusyRollout();
  const auto run = [&](const Kernel<TypeParam>& kernel) {
    const Sim simulator(rollout.system, rollout.environment, rollout.options, kernel);
    typename Sim::Workspace workspace(simulator);
    return Run(simulator, rollout, &workspace);
  };
  ExpectSame(run(ChooseKernel<TypeParam>("scalar")), run(ChooseKernel<TypeParam>("")));
}

TYPED_TEST(SimulatorDeterminism, ARecordedFrameIsTheSame) {
  using Sim = Simulator<TypeParam>;
  const TargetedRollout rollout = BusyRollout();
  const Sim simulator(rollout.system, rollout.environment, rollout.options);
  typename Sim::Workspace workspace(simulator);
  const NodeStates<TypeParam> start = simulator.MakeState(rollout.position, rollout.velocity);
  NodeStates<TypeParam> advanced = start, recorded = start;
  simulator.AdvanceFrame(rollout.frames[0], &advanced, &workspace);
  simulator.RecordFrame(rollout.frames[0], &recorded, &workspace);
  EXPECT_TRUE(SameBits(recorded, advanced));

  NodeStates<TypeParam> bar = simulator.MakeState(rollout.target[0], rollout.target[1]);
  NodeStates<TypeParam> recorded_bar = bar;
  SystemGradient gradient(rollout.system), recorded_gradient(rollout.system);
  simulator.RecordedFrameAdjoint(&recorded_bar, &recorded_gradient, &workspace);
  simulator.AdvanceFrameAdjoint(start, rollout.frames[0], &bar, &gradient, &workspace);
  EXPECT_TRUE(SameBits(recorded_bar, bar));
  ExpectSame(recorded_gradient, gradient);
}

TYPED_TEST(SimulatorDeterminism, ThreadsDoNotDisturbEachOther) {
  using Sim = Simulator<TypeParam>;
  const TargetedRollout rollout = BusyRollout();
  const Sim simulator(rollout.system, rollout.environment, rollout.options);
  typename Sim::Workspace workspace(simulator);
  const Output<TypeParam> alone = Run(simulator, rollout, &workspace);
  std::vector<Output<TypeParam>> outputs(2, alone);
  std::vector<std::thread> threads;
  for (Output<TypeParam>& output : outputs) {
    threads.emplace_back([&] {
      typename Sim::Workspace own(simulator);
      for (int repeat = 0; repeat < 20; ++repeat) output = Run(simulator, rollout, &own);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Output<TypeParam>& output : outputs) ExpectSame(output, alone);
}

// 8 sub-steps of a frame, or a sub-step of each of 8 frames: the adjoint starts from the states
// that AdvanceFrame gave in the one case and that it recomputed in the other.
TYPED_TEST(SimulatorDeterminism, TheAdjointRecomputesTheBitsOfAdvanceFrame) {
  using Sim = Simulator<TypeParam>;
  TargetedRollout whole = RandomRollout(1, 1);
  whole.environment.ground = Eigen::Vector4d(0, 0, 1, -0.08);
  whole.options = {.frame_time = 0.008, .substeps = 8, .controller_velocity = true};
  whole.frames[0].controllers_end = whole.frames[0].controllers_start;  // no rounding of their way
  TargetedRollout parts = whole;
  parts.options = {.frame_time = 0.001, .substeps = 1, .controller_velocity = true};
  parts.frames.assign(8, whole.frames[0]);
  parts.target.assign(8, whole.target[0]);
  whole.target.assign(2, whole.target[0]);
  const Sim one(whole.system, whole.environment, whole.options);
  const Sim eight(parts.system, parts.environment, parts.options);
  typename Sim::Workspace one_workspace(one), eight_workspace(eight);
  const Output<TypeParam> all = Run(one, whole, &one_workspace);
  const Output<TypeParam> step = Run(eight, parts, &eight_workspace);
  EXPECT_NE(all.gradient.contact.surface.friction, 0);
  EXPECT_TRUE(SameBits(all.states.back(), step.states.back()));
  EXPECT_TRUE(SameBits(all.state_bars.back(), step.state_bars.back()));
}

}  // namespace
}  // namespace physpring
