// SPDX-License-Identifier: Apache-2.0
// A sub-step takes its memory from the workspace: a frame that has been simulated once asks for as
// little memory with many sub-steps as with few.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/support/targeted_rollout.h"

namespace {

std::atomic<int> allocations = 0;

void* Allocate(std::size_t size, std::size_t alignment) {
  ++allocations;
  // a whole number of alignments, as aligned_alloc wants it
  void* const memory = std::aligned_alloc(alignment, (size / alignment + 1) * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

// Out of line: inlined, g++ 12 takes it for the wrong end of a plain operator new and warns.
[[gnu::noinline]] void Release(void* memory) noexcept { std::free(memory); }

}  // namespace

void* operator new(std::size_t size) { return Allocate(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return Allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { Release(memory); }
void operator delete(void* memory, std::size_t) noexcept { Release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { Release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { Release(memory); }

namespace physpring {
namespace {

// Particles that collide with each other, with the ground and with a geom, in each sub-step.
TargetedRollout Crowd() {
  TargetedRollout rollout = RandomRollout(1, 1);
  rollout.position *= 0.3;
  rollout.velocity *= 3;
  rollout.system.contact.collision_distance = 0.03;
  rollout.environment.ground = Eigen::Vector4d(0, 0, 1, 0);
  Geom sphere;
  sphere.radius = 0.02;
  rollout.frames[0].geoms = {sphere};
  return rollout;
}

struct Count {
  int forward, with_adjoint;
};

// Allocations of the same frame, simulated for the second time.
template <class Real>
Count CountAllocations(TargetedRollout rollout, int substeps) {
  rollout.options.substeps = substeps;
  const Simulator<Real> simulator(rollout.system, rollout.environment, rollout.options);
  typename Simulator<Real>::Workspace workspace(simulator);
  const NodeStates<Real> start = simulator.MakeState(rollout.position, rollout.velocity);
  SystemGradient gradient(rollout.system);
  Count count{};
  for (int repeat = 0; repeat < 2; ++repeat) {
    NodeStates<Real> state = start;
    int before = allocations;
    simulator.AdvanceFrame(rollout.frames[0], &state, &workspace);
    count.forward = allocations - before;
    before = allocations;
    simulator.AdvanceFrameAdjoint(start, rollout.frames[0], &state, &gradient, &workspace);
    count.with_adjoint = allocations - before;
  }
  EXPECT_NE(gradient.contact.object.restitution, 0);
  EXPECT_NE(gradient.contact.surface.restitution, 0);
  return count;
}

template <class Real>
class SimulatorAllocation : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(SimulatorAllocation, Reals);

TYPED_TEST(SimulatorAllocation, DoesNotGrowWithTheSubsteps) {
  const TargetedRollout crowd = Crowd();
  const Count few = CountAllocations<TypeParam>(crowd, 10);
  const Count many = CountAllocations<TypeParam>(crowd, 100);
  EXPECT_EQ(few.forward, many.forward);
  EXPECT_EQ(few.with_adjoint, many.with_adjoint);
  EXPECT_GT(many.with_adjoint, 0);  // it is these allocations that are counted
}

TYPED_TEST(SimulatorAllocation, DoesNotGrowWithTheSubstepsWhereEffectsActAlongTheSprings) {
  TargetedRollout crowd = Crowd();
  crowd.system.effects = {{"viscoelastic", Eigen::Vector2d(0.5, 0.02)}};
  const Count few = CountAllocations<TypeParam>(crowd, 10);
  const Count many = CountAllocations<TypeParam>(crowd, 100);
  EXPECT_EQ(few.forward, many.forward);
  EXPECT_EQ(few.with_adjoint, many.with_adjoint);
}

}  // namespace
}  // namespace physpring
