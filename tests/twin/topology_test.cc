// SPDX-License-Identifier: Apache-2.0
#include "twin/topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "tests/support/forked_rod.h"
#include "tests/support/random_system.h"
#include "twin/error.h"

namespace physpring {
namespace {

using Eigen::Vector3d;
using Springs = std::vector<std::array<int, 2>>;

const Rod kNoRod;

// Joins every point of `from` to the nearest `count` of `to` within `radius`, by a full search.
void JoinAll(const Points& x, const std::vector<int>& from, const std::vector<int>& to,
             double radius, int count, std::set<std::array<int, 2>>* springs) {
  for (int i : from) {
    std::vector<std::pair<double, int>> near;
    for (int j : to) {
      const double distance = (x.col(i) - x.col(j)).norm();
      if (j != i && distance < radius) near.emplace_back(distance, j);
    }
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), static_cast<std::size_t>(count)));
    for (const auto& [distance, j] : near) springs->insert({std::min(i, j), std::max(i, j)});
  }
}

std::vector<int> Range(int first, int last) {
  std::vector<int> range(last - first);
  std::iota(range.begin(), range.end(), first);
  return range;
}

bool Connected(int nodes, const Springs& springs) {
  std::vector<int> group = Range(0, nodes);
  for (int round = 0; round < nodes; ++round) {
    for (const auto& [a, b] : springs) {
      if (a < nodes && b < nodes) group[a] = group[b] = std::min(group[a], group[b]);
    }
  }
  return std::count(group.begin(), group.end(), 0) == nodes;
}

TEST(Topology, TakesTheNearestWhereTheRadiusHoldsTooFew) {
  const Points x = Random(4).Box(200, 0.5);
  TopologyOptions options;
  options.radius = 0.05;  // few or none
  options.max_neighbours = 20;
  options.min_neighbours = 5;
  std::set<std::array<int, 2>> expected;
  JoinAll(x, Range(0, 200), Range(0, 200), 0.05, 20, &expected);
  JoinAll(x, Range(0, 200), Range(0, 200), 10, 5, &expected);
  EXPECT_EQ(BuildSprings(x, 0, kNoRod, options, "test"), Springs(expected.begin(), expected.end()));
}

TEST(Topology, HybridSearchIsThatOfAFullSearch) {
  const Points x = Random(1).Box(300, 0.5);
  TopologyOptions options;
  options.radius = 0.25;
  options.max_neighbours = 10;
  std::set<std::array<int, 2>> expected;
  JoinAll(x, Range(0, 300), Range(0, 300), 0.25, 10, &expected);
  const Springs sorted(expected.begin(), expected.end());
  ASSERT_TRUE(Connected(300, sorted));
  EXPECT_EQ(BuildSprings(x, 0, kNoRod, options, "x"), sorted);
  // both limits were felt
  std::set<std::array<int, 2>> nearest, within;
  JoinAll(x, Range(0, 300), Range(0, 300), 1e9, 10, &nearest);
  JoinAll(x, Range(0, 300), Range(0, 300), 0.25, 300, &within);
  EXPECT_LT(expected.size(), nearest.size());
  EXPECT_LT(expected.size(), within.size());
}

TEST(Topology, ControllersAreJoinedToNodesOnly) {
  const Points x = Random(2).Box(104, 0.5);
  TopologyOptions options;
  options.max_neighbours = 8;
  options.controller_radius = 0.3;
  options.controller_max_neighbours = 6;
  std::set<std::array<int, 2>> expected;
  JoinAll(x, Range(0, 100), Range(0, 100), 1e9, 8, &expected);
  JoinAll(x, Range(100, 104), Range(0, 100), 0.3, 6, &expected);
  EXPECT_EQ(BuildSprings(x, 4, kNoRod, options, "x"), Springs(expected.begin(), expected.end()));
}

// Nodes along a helix whose turns are nearer to each other than the nodes of a turn.
TEST(Topology, ARodIsJoinedAlongItsLength) {
  const int nodes = 30;
  Points x(3, nodes + 1);
  Eigen::VectorXd order(nodes + 1);
  std::vector<int> place = Range(0, nodes);  // of each node along the rod
  Random random(3);
  for (int i = nodes - 1; i > 0; --i)
    std::swap(place[i], place[static_cast<int>(random(0, i + 1))]);
  for (int i = 0; i <= nodes; ++i) {
    const double angle = i < nodes ? place[i] : 0.5;
    x.col(i) << std::cos(angle), std::sin(angle), 0.01 * angle;
    order[i] = 0.1 * angle;
  }
  TopologyOptions options;
  options.max_neighbours = 6;
  options.controller_max_neighbours = 2;
  std::set<std::array<int, 2>> expected;
  for (int i = 0; i < nodes; ++i) {
    for (int j = 0; j < i; ++j) {
      if (std::abs(place[i] - place[j]) <= 3) expected.insert({j, i});
    }
    if (place[i] <= 1) expected.insert({i, nodes});  // the controller stands between 0 and 1
  }
  const Springs found = BuildSprings(x, 1, PlainRod(order), options, "x");
  EXPECT_EQ(found, Springs(expected.begin(), expected.end()));
  const Eigen::VectorXd length = SpringLengths(found, x, PlainRod(order));
  for (std::size_t e = 0; e < found.size(); ++e) {
    EXPECT_DOUBLE_EQ(length[e], std::abs(order[found[e][0]] - order[found[e][1]]));
  }
}

// A controller at the end of a branch, as one with an edge.
TEST(Topology, ARodIsJoinedAlongAllItsBranches) {
  Points x(3, 11);
  x << ForkedPlaces(), ForkedPlaces().col(9) + Vector3d(0, -0.1, 0);
  RodEdges edges = kForkedEdges;
  edges.push_back({9, 10});
  const Rod rod = RodOfEdges(edges, x);
  TopologyOptions options;
  options.max_neighbours = 4;
  options.controller_max_neighbours = 2;
  const Springs found = BuildSprings(x, 1, rod, options, "x");
  const auto joined_to = [&](int node) {
    std::set<int> nodes;
    for (const auto& [a, b] : found) {
      if (a == node) nodes.insert(b);
      if (b == node) nodes.insert(a);
    }
    return nodes;
  };
  // within two steps of the joint, each to each
  EXPECT_EQ(joined_to(7), (std::set{0, 1, 2, 3, 4, 6, 8, 9}));
  EXPECT_EQ(joined_to(2), (std::set{0, 1, 3, 4, 6, 7, 8, 9}));
  EXPECT_EQ(joined_to(5), (std::set{3, 4}));
  EXPECT_EQ(joined_to(10), (std::set{9, 8}));
  const Eigen::VectorXd length = SpringLengths(found, x, rod);
  for (std::size_t e = 0; e < found.size(); ++e) {
    EXPECT_DOUBLE_EQ(length[e], RodLengths(rod).Between(found[e][0], found[e][1], x));
  }
}

TEST(Topology, AChainIsBracedAtItsJoints) {
  const Springs chain = ChainSprings(ForkedRod(), 10);
  std::set<std::array<int, 2>> expected(kForkedEdges.begin(), kForkedEdges.end());
  const std::array<std::array<int, 2>, 4> ways = {{{1, 0}, {3, 4}, {6, 7}, {8, 9}}};
  for (std::size_t i = 0; i < ways.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (int a : ways[i]) {
        for (int b : ways[j]) expected.insert({std::min(a, b), std::max(a, b)});
      }
    }
  }
  EXPECT_EQ(chain, Springs(expected.begin(), expected.end()));
  EXPECT_EQ(ChainSprings(PlainRod(Eigen::Vector3d(0, 0.2, 0.1)), 3), (Springs{{0, 2}, {1, 2}}));
}

TEST(Topology, SpringLengthsAreDistances) {
  Points x(3, 2);
  x.col(0) << 1, 2, 3;
  x.col(1) << 3, 5, 9;
  EXPECT_DOUBLE_EQ(SpringLengths({{0, 1}}, x, kNoRod)[0], 7);
}

// Two cubes of 3 x 3 x 3 nodes, 1 m apart each, with `gap` between them.
Points TwoCubes(double gap) {
  Points x(3, 54);
  for (int i = 0; i < 54; ++i) {
    x.col(i) << i % 3 + (i < 27 ? 0 : 2 + gap), i / 3 % 3, i / 9 % 3;
  }
  return x;
}

TEST(Topology, GroupsThatTheSearchLeavesApartAreJoined) {
  const Points x = TwoCubes(2.5);
  TopologyOptions options;
  options.radius = 1.1;
  const Springs springs = BuildSprings(x, 0, kNoRod, options, "x");
  EXPECT_TRUE(Connected(54, springs));
  int across = 0;
  for (const auto& [a, b] : springs) {
    if (a < 27 && b >= 27) {
      ++across;
      EXPECT_LE((x.col(a) - x.col(b)).norm(), 2.5 + 1) << a << " " << b;
    }
  }
  EXPECT_GE(across, 3);  // fewer would be a hinge
}

TEST(Topology, OfOneGroupIsLeftAsItIs) {
  const Points x = TwoCubes(1);
  TopologyOptions options;
  options.radius = 1.1;
  EXPECT_EQ(BuildSprings(x, 0, kNoRod, options, "x").size(), 2 * 54 + 9);
}

std::string ErrorOf(const Points& x, int controllers, const TopologyOptions& options,
                    const Rod& rod = kNoRod) {
  try {
    BuildSprings(x, controllers, rod, options, "toy.npz");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void ExpectMentions(const std::string& message, const std::vector<std::string>& words) {
  EXPECT_EQ(message.rfind("toy.npz: ", 0), 0) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const std::string& word : words) {
    EXPECT_NE(message.find(word), std::string::npos) << word << " is missing in: " << message;
  }
}

TEST(Topology, CoincidentNodesAreAnError) {
  Points x = Random(4).Box(10, 1);
  x.col(7) = x.col(3);
  ExpectMentions(ErrorOf(x, 0, {}), {"particles 3 and 7", "same place"});
}

TEST(Topology, CoincidentNodesOfARodAreAnError) {
  Eigen::VectorXd order = Eigen::VectorXd::LinSpaced(10, 0, 1);
  order[5] = order[2];
  ExpectMentions(ErrorOf(Random(4).Box(10, 1), 0, {}, PlainRod(order)),
                 {"particles 2 and 5", "same place"});
}

TEST(Topology, SeparateObjectsAreAnError) {
  ExpectMentions(ErrorOf(TwoCubes(5.5), 0, {.radius = 1.1}),
                 {"separate objects", "5.5 m", "at most 1 m", "particle 27", "particle"});
}

TEST(Topology, NothingToJoinIsAnError) {
  ExpectMentions(ErrorOf(Points::Zero(3, 1), 0, {}), {"1 particle"});
  ExpectMentions(ErrorOf(Points(3, 0), 0, {}), {"0 particle"});
  ExpectMentions(ErrorOf(Random(1).Box(2, 1), 2, {}), {"0 particle"});
}

TEST(Topology, AControllerOutOfReachOfTheOnlyNodeIsAnError) {
  Points x = Points::Zero(3, 2);
  x(0, 1) = 0.5;
  ExpectMentions(ErrorOf(x, 1, {.controller_radius = 0.1}), {"0.1 m"});
}

TEST(Topology, AControllerOnANodeIsAnError) {
  Points x = Random(5).Box(10, 1);
  x.col(9) = x.col(4);
  ExpectMentions(ErrorOf(x, 1, {}), {"controller 0", "particle 4", "same place"});
}

}  // namespace
}  // namespace physpring
