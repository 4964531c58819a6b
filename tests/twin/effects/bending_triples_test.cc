// SPDX-License-Identifier: Apache-2.0
#include "twin/effects/bending_triples.h"

#include <gtest/gtest.h>

#include <set>

namespace physpring {
namespace {

// Nodes on a line, each joined to the next two: of all springs that leave a node, those to the same
// distance on either side belong together, wherever the line lies.
TEST(BendingTriples, OfALineAreAsFarOnEitherSide) {
  constexpr int kNodes = 12;
  const Eigen::Vector3d step(0.011, -0.007, 0.013);
  SpringMassSystem system;
  system.position.resize(3, kNodes);
  for (int i = 0; i < kNodes; ++i) system.position.col(i) = i * step;
  system.mass = Eigen::VectorXd::Ones(kNodes);
  std::set<std::array<int, 3>> expected;
  for (int reach : {1, 2}) {
    for (int i = 0; i + reach < kNodes; ++i) system.springs.push_back({i, i + reach});
    for (int i = reach; i + reach < kNodes; ++i) expected.insert({i - reach, i, i + reach});
  }
  std::set<std::array<int, 3>> found;
  for (const BendingTriple& triple : FindBendingTriples(system)) {
    found.insert({triple.a, triple.b, triple.c});
    EXPECT_NEAR(triple.length, (triple.b - triple.a) * step.norm(), 1e-12);
  }
  EXPECT_EQ(found, expected);
}

}  // namespace
}  // namespace physpring
