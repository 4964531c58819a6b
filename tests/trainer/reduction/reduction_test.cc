// SPDX-License-Identifier: Apache-2.0
// What holds for every way to reduce a system, on random ones.
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "tests/support/interrupted_work.h"
#include "tests/support/random_system.h"
#include "trainer/projection/galerkin.h"
#include "trainer/reduction/clusters.h"
#include "trainer/reduction/gramian.h"
#include "trainer/reduction/kmeans.h"
#include "trainer/reduction/registry.h"
#include "twin/error.h"

namespace physpring {
namespace {

const Eigen::Vector3d kUp(0, 0, 1);

// What a reduction that needs no recordings makes of a system.
Assignment Assign(const Reduction& reduction, const SpringMassSystem& system, int nodes,
                  std::uint64_t seed) {
  Twin twin;
  twin.levels.push_back({system, {}, 0});
  TrainOptions options;
  options.seed = seed;
  const GraphNetwork network(2, seed);
  return RunToTheEnd([&](const Work& work) {
    return reduction
        .Reduce({twin, nodes, kUp, FitData(), options, network, network.first_weights()}, work)
        .candidates.at(0);
  });
}

// All those.
std::vector<const Reduction*> Reductions() {
  std::vector<const Reduction*> reductions;
  for (const auto& reduction : AllReductions()) {
    if (!reduction->LearnsFeatures()) reductions.push_back(reduction.get());
  }
  return reductions;
}

// The Laplacian of all nodes, controllers included, in N/m.
Eigen::MatrixXd LaplacianOf(const SpringMassSystem& system) {
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(system.position.cols(), system.position.cols());
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    laplacian(a, a) += system.stiffness[e];
    laplacian(b, b) += system.stiffness[e];
    laplacian(a, b) -= system.stiffness[e];
    laplacian(b, a) -= system.stiffness[e];
  }
  return laplacian;
}

TEST(Reduction, IsFoundByItsName) {
  for (const auto& reduction : AllReductions()) {
    EXPECT_EQ(&GetReduction(reduction->name()), reduction.get());
    EXPECT_FALSE(reduction->help().empty());
  }
  EXPECT_EQ(GetReduction(TrainOptions().reduction).name(), AllReductions()[0]->name());
  EXPECT_THROW(GetReduction("best"), Error);
}

// Two bodies that no spring joins.
SpringMassSystem TwoBodies() {
  SpringMassSystem system = RandomSystem(30, 0, 7);
  const SpringMassSystem one = system;
  Points both(3, 60);
  both << one.position, one.position.colwise() + Eigen::Vector3d(1, 0, 0);
  system.position = both;
  const auto twice = [](Eigen::VectorXd* v) {
    const Eigen::VectorXd once = *v;
    v->resize(2 * once.size());
    *v << once, once;
  };
  twice(&system.mass);
  twice(&system.stiffness);
  twice(&system.rest_length);
  twice(&system.dashpot);
  twice(&system.contact_radius);
  for (auto [a, b] : one.springs) system.springs.push_back({a + 30, b + 30});
  return system;
}

void ExpectConnectedAndOnto(const SpringMassSystem& system, const Assignment& assignment,
                            int clusters) {
  ASSERT_EQ(static_cast<int>(assignment.size()), system.node_count());
  EXPECT_EQ(std::set<int>(assignment.begin(), assignment.end()).size(), clusters);
  EXPECT_EQ(CountClusters(assignment), clusters);
  // the springs within clusters leave as many parts as there are clusters
  SpringMassSystem within = system;
  within.springs.clear();
  for (auto [a, b] : system.springs) {
    if (std::max(a, b) < system.node_count() && assignment[a] == assignment[b]) {
      within.springs.push_back({a, b});
    }
  }
  EXPECT_EQ(SpringGraph(within).parts, clusters);
}

TEST(Reduction, ClustersAreConnectedOntoAndAsManyAsAskedFor) {
  for (const Reduction* reduction : Reductions()) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const SpringMassSystem system = RandomSystem(60, 2, seed);
      for (int nodes : {60, 36, 24, 18, 5}) {
        SCOPED_TRACE(reduction->name() + std::to_string(seed) + " to " + std::to_string(nodes));
        const int budget = ClusterBudget(SpringGraph(system), nodes);
        ExpectConnectedAndOnto(system, Assign(*reduction, system, nodes, seed), budget);
      }
    }
  }
}

TEST(Reduction, NeverMergesSeparateObjects) {
  const SpringMassSystem system = TwoBodies();
  for (const Reduction* reduction : Reductions()) {
    for (int nodes : {20, 1}) {
      const Assignment assignment = Assign(*reduction, system, nodes, 3);
      SCOPED_TRACE(reduction->name());
      const std::set<int> left(assignment.begin(), assignment.begin() + 30);
      for (int i = 30; i < 60; ++i) EXPECT_FALSE(left.contains(assignment[i]));
    }
  }
}

TEST(Reduction, IsTheSameForTheSameSeed) {
  const SpringMassSystem system = RandomSystem(60, 2, 4);
  for (const Reduction* reduction : Reductions()) {
    EXPECT_EQ(Assign(*reduction, system, 20, 9), Assign(*reduction, system, 20, 9))
        << reduction->name();
  }
  for (const char* drawn : {"random", "kmeans"}) {
    const Reduction& reduction = GetReduction(drawn);
    EXPECT_NE(Assign(reduction, system, 20, 9), Assign(reduction, system, 20, 10)) << drawn;
  }
}

TEST(Galerkin, KeepsTheMassAndProjectsTheLaplacian) {
  for (const Reduction* reduction : Reductions()) {
    SCOPED_TRACE(reduction->name());
    const SpringMassSystem fine = RandomSystem(60, 2, 5);
    const Assignment assignment = Assign(*reduction, fine, 21, 1);
    const SpringMassSystem coarse = Project(fine, assignment, kUp).system;
    coarse.Validate("coarse");
    EXPECT_NEAR(coarse.mass.sum(), fine.mass.sum(), 1e-15 * fine.mass.sum() * 60);
    // P^T L P, P with the controllers
    Eigen::MatrixXd p = Eigen::MatrixXd::Zero(62, 23);
    for (int i = 0; i < 60; ++i) p(i, assignment[i]) = 1;
    p(60, 21) = p(61, 22) = 1;
    const Eigen::MatrixXd laplacian = LaplacianOf(coarse);
    const double scale = laplacian.cwiseAbs().maxCoeff();
    EXPECT_LT((laplacian - p.transpose() * LaplacianOf(fine) * p).cwiseAbs().maxCoeff(),
              1e-13 * scale);
    EXPECT_LT(laplacian.rowwise().sum().cwiseAbs().maxCoeff(), 1e-13 * scale);
    Random random(8);
    for (int trial = 0; trial < 50; ++trial) {
      const Eigen::VectorXd x = random.Box(23, 1).row(0).transpose();
      EXPECT_GE(x.dot(laplacian * x), -1e-12 * scale);
    }
  }
}

TEST(Galerkin, TheIdentityIsTheSystemBitForBit) {
  const SpringMassSystem fine = RandomSystem(50, 3, 6);
  const Assignment identity = KMeansAssignment(fine, 50, 1);
  const SpringMassSystem coarse = Project(fine, identity, kUp).system;
  EXPECT_EQ(coarse.position, fine.position);
  EXPECT_EQ(coarse.mass, fine.mass);
  EXPECT_EQ(coarse.springs, fine.springs);
  EXPECT_EQ(coarse.stiffness, fine.stiffness);
  EXPECT_EQ(coarse.rest_length, fine.rest_length);
  EXPECT_EQ(coarse.dashpot, fine.dashpot);
  EXPECT_EQ(coarse.drag, fine.drag);
  EXPECT_EQ(coarse.contact_radius, fine.contact_radius);
}

// A chain that hangs at rest under a controller: its pairs of nodes hang at rest, too.
TEST(Galerkin, RestsWhereTheFineSystemRests) {
  constexpr int kNodes = 8;
  constexpr double kMass = 0.01, kGravity = 9.81, kStiffness = 200, kSpacing = 0.02;
  SpringMassSystem chain;
  chain.controllers = 1;
  chain.position = Points::Zero(3, kNodes + 1);
  chain.mass = Eigen::VectorXd::Constant(kNodes, kMass);
  chain.contact_radius = Eigen::VectorXd::Zero(kNodes);
  chain.stiffness = Eigen::VectorXd::Constant(kNodes, kStiffness);
  chain.dashpot = Eigen::VectorXd::Zero(kNodes);
  chain.rest_length.resize(kNodes);
  Assignment pairs;
  for (int i = 0; i < kNodes; ++i) {
    chain.position(2, i) = -kSpacing * (i + 1);
    chain.springs.push_back({i == 0 ? kNodes : i - 1, i});
    chain.rest_length[i] = kSpacing - (kNodes - i) * kMass * kGravity / kStiffness;
    pairs.push_back(i / 2);
  }
  ASSERT_GT(chain.rest_length.minCoeff(), 0);
  const SpringMassSystem coarse = Project(chain, pairs, kUp).system;
  for (int e = 1; e < coarse.spring_count(); ++e) {
    const auto [a, b] = coarse.springs[e];
    const double length = (coarse.position.col(b) - coarse.position.col(a)).norm();
    const double weight_below = coarse.mass.tail(coarse.node_count() - e).sum() * kGravity;
    EXPECT_NEAR(coarse.stiffness[e] * (length - coarse.rest_length[e]), weight_below, 1e-12);
  }
}

TEST(Galerkin, AClusterTouchesTheGroundWithItsLowestMember) {
  SpringMassSystem fine = RandomSystem(20, 0, 2);
  const Assignment all(20, 0);
  const SpringMassSystem coarse = Project(fine, all, kUp).system;
  EXPECT_NEAR(coarse.position(2, 0) - coarse.contact_radius[0],
              fine.position.row(2).minCoeff() - fine.contact_radius[0], 1e-15);
}

// Against a Lyapunov solution's integral, by simulation: two oscillators on one controller.
TEST(Gramian, DistancesAreThoseOfImpulseResponses) {
  SpringMassSystem system;
  system.controllers = 1;
  system.position = Points::Random(3, 4);
  system.mass = Eigen::Vector3d(1, 2, 1.5);
  system.contact_radius = Eigen::Vector3d::Zero();
  system.springs = {{0, 3}, {0, 1}, {1, 2}};
  system.stiffness = Eigen::Vector3d(30, 20, 10);
  system.rest_length = Eigen::Vector3d::Ones();
  // proportional to the stiffness, so that the modes are exact
  system.dashpot = 0.02 * system.stiffness;
  system.drag = 0.3;
  const Eigen::MatrixXd features = GramianFeatures(system, 3);

  Eigen::Matrix3d l, d;
  l << 50, -20, 0, -20, 30, -10, 0, -10, 10;
  d = 0.02 * l;
  d.diagonal() += 0.3 * system.mass;
  Eigen::Vector3d x = Eigen::Vector3d::Zero(), v(30 / system.mass[0], 0, 0);
  Eigen::Matrix3d integral = Eigen::Matrix3d::Zero();
  constexpr double kStep = 2e-5;
  for (int step = 0; step < 3000000; ++step) {
    v -= kStep * (l * x + d * v).cwiseQuotient(system.mass);
    x += kStep * v;
    integral += kStep * x * x.transpose();
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double expected = integral(i, i) + integral(j, j) - 2 * integral(i, j);
      // the simulation is of first order in its step
      EXPECT_NEAR((features.row(i) - features.row(j)).squaredNorm(), expected,
                  1e-3 * integral(0, 0));
    }
  }
}

}  // namespace
}  // namespace physpring
