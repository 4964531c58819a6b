// SPDX-License-Identifier: Apache-2.0
#include "twin/spring_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "tests/support/random_system.h"
#include "tests/support/simulation.h"
#include "twin/spring_force.h"
#include "twin/topology.h"

namespace physpring {
namespace {

// 2,000 nodes in a cube, about 15 springs a node.
SpringMassSystem LargeSystem() {
  SpringMassSystem system = Particles(Random(1).Box(2000, 0.5), 0.01);
  TopologyOptions options;
  options.max_neighbours = 24;
  system.springs = BuildSprings(system.position, 0, {}, options, "large");
  system.rest_length = SpringLengths(system.springs, system.position, {});
  system.stiffness.setConstant(system.spring_count(), 10);
  system.dashpot.setConstant(system.spring_count(), 0.1);
  return system;
}

void ExpectEverySpringOnce(const SpringMassSystem& system) {
  const SpringBlocks<double> blocks(system);
  std::vector<int> count(system.springs.size(), 0);
  ASSERT_EQ(blocks.size(), kSpringBlock * blocks.blocks());
  for (int i = 0; i < blocks.size(); ++i) {
    const int a = blocks.a[i / kSpringBlock], b = blocks.b[i], e = blocks.spring[i];
    if (e < 0) {
      EXPECT_EQ(b, blocks.spare_node);
      EXPECT_EQ(blocks.stiffness[i], 0);
      EXPECT_EQ(blocks.dashpot[i], 0);
      continue;
    }
    ++count[e];
    const auto [first, second] = system.springs[e];
    EXPECT_TRUE((a == first && b == second) || (a == second && b == first)) << e;
    EXPECT_EQ(blocks.stiffness[i], system.stiffness[e]);
    EXPECT_EQ(blocks.rest_length[i], system.rest_length[e]);
    EXPECT_EQ(blocks.dashpot[i], system.dashpot[e]);
  }
  EXPECT_EQ(std::count(count.begin(), count.end(), 1), system.spring_count());
}

TEST(SpringBlocks, HoldEverySpringOnce) {
  ExpectEverySpringOnce(LargeSystem());
  for (int nodes = 2; nodes < 12; ++nodes) ExpectEverySpringOnce(RandomSystem(nodes, 2, nodes));
}

TEST(SpringBlocks, FillTheWidestVector) {
  for (int nodes = 2; nodes < 12; ++nodes) {
    EXPECT_EQ(SpringBlocks<float>(RandomSystem(nodes, 2, nodes)).blocks() % kBlocksAtOnce, 0);
  }
}

TEST(SpringBlocks, HoldNoNodeTwice) {
  const SpringBlocks<double> blocks(LargeSystem());
  for (int block = 0; block < blocks.blocks(); ++block) {
    std::set<int> nodes{blocks.a[block]};
    int springs = 0;
    for (int s = 0; s < kSpringBlock; ++s) {
      if (blocks.spring[kSpringBlock * block + s] < 0) continue;
      nodes.insert(blocks.b[kSpringBlock * block + s]);
      ++springs;
    }
    EXPECT_EQ(static_cast<int>(nodes.size()), springs + 1) << block;
  }
}

TEST(SpringBlocks, AreFilledTo95Percent) {
  const SpringMassSystem system = LargeSystem();
  ASSERT_GT(system.spring_count(), 25000);
  EXPECT_GT(system.spring_count(), 0.95 * SpringBlocks<double>(system).size());
}

TEST(SpringBlocks, OrderIsThatOfTheTopologyOnly) {
  const SpringMassSystem system = RandomSystem(30, 2, 3);
  SpringMassSystem other = system;
  other.position *= -2;
  other.stiffness *= 3;
  EXPECT_EQ(SpringBlocks<double>(system).spring, SpringBlocks<float>(other).spring);
}

// The forces of springs one by one, without blocks.
Points ForcesOf(const SpringMassSystem& system, const Points& x, const Points& v) {
  Points force = Points::Zero(3, x.cols());
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    const Eigen::Vector3d d = x.col(b) - x.col(a), n = d.normalized();
    const double tension = system.stiffness[e] * (d.norm() - system.rest_length[e]) +
                           system.dashpot[e] * n.dot(v.col(b) - v.col(a));
    force.col(a) += tension * n;
    force.col(b) -= tension * n;
  }
  return force;
}

TEST(SpringBlocks, FillingAddsNoForce) {
  for (int nodes = 2; nodes < 12; ++nodes) {
    const SpringMassSystem system = RandomSystem(nodes, 2, nodes);
    const SpringBlocks<double> blocks(system);
    const Points v = Random(nodes).Box(nodes + 2, 1);
    NodeStates<double> state(blocks.spare_node + 1);
    for (int i = 0; i < nodes + 2; ++i) {
      for (int j = 0; j < 3; ++j) {
        state[i].x[j] = system.position(j, i);
        state[i].v[j] = v(j, i);
      }
    }
    NodeForces<double> force(state.size());
    AddSpringForces(blocks.View(), state.data(), force.data());
    const Points expected = ForcesOf(system, system.position, v);
    for (int i = 0; i < nodes + 2; ++i) {
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(force[i].f[j], expected(j, i), 1e-13);  // rounding
    }
    for (double f : force[blocks.spare_node].f) EXPECT_EQ(f, 0);
  }
}

TEST(SpringBlocks, FillingAtTheOriginAddsNothingToTheGradient) {
  SpringMassSystem system = Particles(Points::Zero(3, 3), 1);
  system.position.col(1) << 0.1, 0, 0;
  system.position.col(2) << 0.1, 0.1, 0;
  AddSpring(0, 1, 10, 0.05, 1, &system);
  AddSpring(1, 2, 10, 0.05, 1, &system);
  const SpringBlocks<double> blocks(system);
  NodeStates<double> state(blocks.spare_node + 1), state_bar(state.size());
  NodeForces<double> force_bar(state.size());
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) state[i].x[j] = system.position(j, i);
  }
  force_bar[0].f[1] = 2;  // across the spring: (I - n n^T) F / l = -k (l - L) / l = -5 N/m
  SpringBlockGradient<double> gradient(blocks.size());
  AddSpringForcesAdjoint(blocks.View(), state.data(), force_bar.data(), state_bar.data(),
                         gradient.View());
  EXPECT_NEAR(state_bar[0].x[1], -10, 1e-14);
  EXPECT_NEAR(state_bar[1].x[1], 10, 1e-14);
}

}  // namespace
}  // namespace physpring
