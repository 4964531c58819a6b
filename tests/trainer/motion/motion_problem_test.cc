// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/motion_problem.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random_system.h"
#include "tests/support/swung_rope.h"
#include "trainer/bodies/parameters.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
constexpr int kPoints = 7;

Eigen::VectorXd Uniform(Eigen::Index size, double bound, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd values(size);
  for (double& value : values) value = random(-bound, bound);
  return values;
}

// Two recordings of a rope, of 6 and 4 frames; the second one has two gaps.
struct Case {
  std::vector<Recording> recordings = {SwungRope(kPoints, 6), SwungRope(kPoints, 4)};
  Parameters parameters;
  MotionProblem::Options options;

  Case() : parameters(Start(), {true, true, true, false}) {
    for (Recording& recording : recordings) MoveAs(Start(), true, &recording);
    recordings[1].points[1].col(2).setConstant(kUnseen);
    recordings[1].points[3].col(5).setConstant(kUnseen);
    options.difference = 1e-7;
  }

  SpringMassSystem Start() const {
    SpringMassSystem system = MakeStartSystem(recordings[0], {.max_neighbours = 4});
    ScaleToSubsteps(1 / recordings[0].fps, 8, 0.7, &system);
    return system;
  }
  std::vector<Episode> Episodes() const { return {{&recordings[0], 6}, {&recordings[1], 4}}; }
  MotionProblem Problem() const { return MotionProblem(parameters, Episodes(), options); }
  LiftedMotion::Substeps Substeps() const {
    return LiftedMotion(Episodes(), options).SubstepsOf(Start());
  }
};

TEST(MotionProblem, ResidualsAreOfSeenPointsOfAllRecordings) {
  const Case c;
  const auto r = c.Problem().Residuals(Uniform(c.parameters.size(), 0.1, 1));
  ASSERT_TRUE(r);
  EXPECT_EQ(r->size(), 3 * (5 * kPoints + 3 * kPoints - 2));
  EXPECT_TRUE(r->allFinite());
  EXPECT_GT(r->norm(), 0);
}

TEST(MotionProblem, TheSystemThatMovedTheRecordingsHasNoResiduals) {
  const Case c;
  MotionProblem problem = c.Problem();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(c.parameters.size());
  // Predict may take other sub-steps
  EXPECT_LT(problem.Residuals(zero)->norm(),
            0.2 * problem.Residuals(Uniform(zero.size(), 1, 1))->norm());
}

TEST(MotionProblem, JacobianTransposedTimesIsTheTranspose) {
  const Case c;
  MotionProblem problem = c.Problem();
  const Eigen::VectorXd x = Uniform(c.parameters.size(), 0.1, 1);
  const Eigen::VectorXd r = *problem.Linearise(x);
  for (std::uint64_t seed = 2; seed < 6; ++seed) {
    const Eigen::VectorXd v = Uniform(x.size(), 1, seed), u = Uniform(r.size(), 1, seed + 10);
    const Eigen::VectorXd jv = problem.JacobianTimes(v), ju = problem.JacobianTransposedTimes(u);
    EXPECT_EQ(problem.cuts(), 0);
    EXPECT_NEAR(u.dot(jv), v.dot(ju), 1e-5 * u.norm() * jv.norm()) << seed;
    EXPECT_GT(std::abs(v.dot(ju)), 1e-3 * u.norm() * jv.norm()) << seed;
  }
}

TEST(MotionProblem, WeightsAreThoseOfSquares) {
  Case c;
  const Eigen::VectorXd x = Uniform(c.parameters.size(), 0.1, 1);
  const Eigen::VectorXd even = *c.Problem().Residuals(x);
  c.recordings[0].weight.assign(6, Eigen::MatrixXd::Ones(1, kPoints));
  c.recordings[0].weight[2](0, 3) = 9;
  MotionProblem problem = c.Problem();
  const Eigen::VectorXd r = *problem.Linearise(x);
  Eigen::VectorXd expected = even;
  expected.segment<3>(3 * (kPoints + 3)) *= 3;
  EXPECT_EQ(r, expected);
  const Eigen::VectorXd v = Uniform(x.size(), 1, 2), u = Uniform(r.size(), 1, 12);
  const Eigen::VectorXd jv = problem.JacobianTimes(v), ju = problem.JacobianTransposedTimes(u);
  EXPECT_NEAR(u.dot(jv), v.dot(ju), 1e-5 * u.norm() * jv.norm());
}

TEST(MotionProblem, LineariseGivesTheResiduals) {
  const Case c;
  MotionProblem problem = c.Problem();
  const Eigen::VectorXd x = Uniform(c.parameters.size(), 0.1, 1);
  EXPECT_EQ(*problem.Linearise(x), *problem.Residuals(x));
}

TEST(MotionProblem, GivesTheSameBitsForAnyNumberOfThreads) {
  Case c;
  MotionProblem one = c.Problem();
  c.options.threads = 2;
  MotionProblem two = c.Problem();
  const Eigen::VectorXd x = Uniform(c.parameters.size(), 0.1, 1);
  const Eigen::VectorXd r = *one.Linearise(x);
  EXPECT_EQ(r, *two.Linearise(x));
  EXPECT_EQ(one.JacobianTimes(x), two.JacobianTimes(x));
  EXPECT_EQ(one.JacobianTransposedTimes(r), two.JacobianTransposedTimes(r));
}

TEST(MotionProblem, GivesResidualsAtSeveralPointsAsAtEach) {
  Case c;
  std::vector<Eigen::VectorXd> xs;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    xs.push_back(Uniform(c.parameters.size(), 0.3, seed));  // some take more sub-steps
  }
  xs[3][0] = 12;
  c.options.most_substeps = 100;
  for (bool keep : {false, true}) {
    c.options.keep_substeps = keep;
    MotionProblem problem = c.Problem();
    ASSERT_TRUE(problem.FixSubsteps(xs[0]));
    const auto all = problem.Residuals(xs);
    for (std::size_t i = 0; i < xs.size(); ++i) EXPECT_EQ(all[i], problem.Residuals(xs[i])) << i;
    EXPECT_TRUE(all[0]);
    EXPECT_FALSE(all[3]);
  }
}

TEST(MotionProblem, CannotEvaluateASystemThatNeedsTooManySubsteps) {
  Case c;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(c.parameters.size());
  const int needed = c.Substeps().counts.at(0);
  EXPECT_NEAR(needed, 8, 1);
  c.options.most_substeps = needed;
  EXPECT_TRUE(c.Problem().Residuals(zero));
  c.options.most_substeps = needed - 1;
  EXPECT_FALSE(c.Problem().Residuals(zero));
  EXPECT_TRUE(c.Substeps().empty());
}

TEST(MotionProblem, CannotEvaluateASystemThatDiverges) {
  Case c;
  c.options.rollout.substeps = 3;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(c.parameters.size());
  x[0] = 12;  // exp(12) times as stiff
  EXPECT_FALSE(c.Problem().Residuals(x));
  EXPECT_FALSE(c.Problem().Linearise(x));
}

}  // namespace
}  // namespace physpring
