// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/diagnosis_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/bending_chain.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

// Nodes on a regular grid, each joined to all within 1.8 spacings.
SpringMassSystem Grid(int across, int along, int high) {
  SpringMassSystem system;
  system.position.resize(3, across * along * high);
  int node = 0;
  for (int i = 0; i < across; ++i) {
    for (int j = 0; j < along; ++j) {
      for (int k = 0; k < high; ++k) system.position.col(node++) = Eigen::Vector3d(i, j, k);
    }
  }
  system.mass = Eigen::VectorXd::Ones(node);
  for (int a = 0; a < node; ++a) {
    for (int b = a + 1; b < node; ++b) {
      if ((system.position.col(b) - system.position.col(a)).norm() < 1.8) {
        system.springs.push_back({a, b});
      }
    }
  }
  return system;
}

TEST(IsSolid, ABlockIs) { EXPECT_TRUE(IsSolid(Grid(4, 3, 3))); }

TEST(IsSolid, ALineIsNot) { EXPECT_FALSE(IsSolid(Grid(9, 1, 1))); }

TEST(IsSolid, ASheetIsNotEvenIfItIsCurved) {
  SpringMassSystem sheet = Grid(8, 6, 1);
  EXPECT_FALSE(IsSolid(sheet));
  constexpr double kRadius = 4;  // spacings
  for (int i = 0; i < sheet.position.cols(); ++i) {
    const double angle = sheet.position(0, i) / kRadius;
    sheet.position.col(i)[0] = kRadius * std::sin(angle);
    sheet.position.col(i)[2] = kRadius * std::cos(angle);
  }
  EXPECT_FALSE(IsSolid(sheet));
}

TEST(IsSolid, ARodOfKnownOrderIsNot) {
  SpringMassSystem bundle = Grid(3, 12, 3);
  bundle.rod = PlainRod(bundle.position.row(1));
  EXPECT_FALSE(IsSolid(bundle));
}

// Nodes joined to the next, numbered from both ends towards the middle.
Twin BendingChain() {
  Twin twin;
  SpringMassSystem system = Grid(1, 6, 1);
  system.rod = PlainRod(Eigen::Vector<double, 6>(0, 2, 4, 5, 3, 1));
  system.springs = {{0, 5}, {5, 1}, {1, 4}, {4, 2}, {2, 3}};
  system.effects = {{"bending", Eigen::VectorXd::Constant(1, 1e-3)}};
  twin.levels.push_back({system, {}, 0});
  return twin;
}

TEST(IsBendingChain, OneThatBendsIs) {
  EXPECT_TRUE(IsBendingChain(BendingChain().levels[0].system));
}

TEST(IsBendingChain, OneWithoutBendingOrWithLongerSpringsIsNot) {
  SpringMassSystem system = BendingChain().levels[0].system;
  system.effects[0] = {"tension_only", Eigen::VectorXd::Ones(1)};
  EXPECT_FALSE(IsBendingChain(system));
  system = BendingChain().levels[0].system;
  system.springs.push_back({0, 1});
  EXPECT_FALSE(IsBendingChain(system));
  system = BendingChain().levels[0].system;
  system.rod = {};
  EXPECT_FALSE(IsBendingChain(system));
}

TEST(BodiesOf, AChainIsTheOnlyBodyAndKeepsItsBending) {
  const Twin twin = BendingChain();
  const std::vector<DiagnosisBody> bodies = BodiesOf(twin, {}, true);
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_EQ(bodies[0].kind, DiagnosisBody::Kind::kTrusted);
  ASSERT_EQ(bodies[0].base.effects.size(), 1U);
  EXPECT_EQ(bodies[0].base.effects[0].name, "bending");
}

TEST(BodiesOf, ATwinThatIsOpenAgainIsAlsoTriedAsItWasTrained) {
  const Recording recording = SwungRope(12, 10);
  Twin twin;
  SpringMassSystem system = MakeStartSystem(recording, {});
  system.stiffness *= 20;
  system.dashpot *= 3;
  twin.levels.push_back({system, {}, 1000});
  const std::vector<DiagnosisBody> bodies = BodiesOf(twin, recording, true);
  ASSERT_GT(bodies.size(), 2U);
  EXPECT_EQ(bodies[0].kind, DiagnosisBody::Kind::kOpen);
  EXPECT_EQ(bodies.back().kind, DiagnosisBody::Kind::kTrained);
  const SpringMassSystem& trained = bodies.back().base;
  EXPECT_EQ(trained.springs, system.springs);
  EXPECT_TRUE(trained.stiffness.isApprox(system.stiffness, 0.05));
  EXPECT_NEAR(trained.dashpot.sum() / trained.stiffness.sum(),
              system.dashpot.sum() / system.stiffness.sum(), 1e-9);
  EXPECT_EQ(BodiesOf(twin, recording, false).size(), 1U);
}

}  // namespace
}  // namespace physpring
