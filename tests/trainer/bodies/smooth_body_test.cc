// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/smooth_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/spring_modes.h"
#include "trainer/bodies/spring_net.h"
#include "trainer/bodies/start_system.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kMostRate = 2500;  // sub-steps a second

// A rope whose start needs so many sub-steps a second, and how it is fitted.
struct Rope {
  Recording recording;
  SpringMassSystem start;

  explicit Rope(double rate, double fps = 60, int points = 12)
      : recording(SwungRope(points, 10)),
        start(MakeStartSystem(recording, {.max_neighbours = 6, .controller_max_neighbours = 6})) {
    recording.fps = fps;
    ScaleToSubsteps(1 / fps, rate / fps, kStepSafety, &start);
  }
  SmoothBody Body(bool hands_apart = false) const {
    return {start, recording, SpringNet(), {kMostRate, hands_apart}};
  }
};

double RateOf(const SpringMassSystem& system, double fps) {
  return StableSubsteps(ComputeStabilityBound(system), 1 / fps, kStepSafety) * fps;
}

TEST(SmoothBody, IsItsStartAtZero) {
  const Rope rope(1000);
  const SmoothBody body = rope.Body();
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.size());
  EXPECT_EQ(body.Apply(zero).stiffness, rope.start.stiffness);
  EXPECT_EQ(body.Apply(zero).dashpot, rope.start.dashpot);
  EXPECT_FALSE(body.IsLimited(zero));
}

// A thin plate's modes have deviations in proportion to 1 / eigenvalue.
TEST(SmoothBody, HoldsRoughModesSmallerUnlessTheyAreFew) {
  const Rope rope(1000);
  for (const auto numbers : {SmoothBody::Numbers::kAll, SmoothBody::Numbers::kFew}) {
    const bool few = numbers == SmoothBody::Numbers::kFew;
    const SmoothBody body(rope.start, rope.recording, SpringNet(),
                          {.most_rate = kMostRate, .numbers = numbers});
    const Eigen::MatrixXd precision = body.Precision(Eigen::VectorXd::Zero(body.size()));
    // a rope has one even slope
    const int first = body.factors().first_mode() + (few ? 0 : 1);
    const Eigen::VectorXd roughness = SpringModes(rope.start, 6).roughness;
    for (int m = 0; m < 6; ++m) {
      ASSERT_EQ(body.factors().kind(first + m), Parameters::Kind::kMode);
      const double expected = few ? 1 : roughness[m] * roughness[m];
      EXPECT_NEAR(precision(first + m, first + m) / precision(first, first), expected,
                  1e-9 * expected);
    }
    EXPECT_GT(roughness[5], 10);
  }
}

// Each width is the deviation of what it names, and of nothing else.
TEST(SmoothBody, IsHeldByItsWidths) {
  const Rope rope(1000);
  SmoothBody body = rope.Body(true);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.size());
  const int classes = body.factors().first_class(), modes = body.factors().first_mode();
  const int hands = classes + body.factors().classes().lengths;
  const SmoothBody::Widths wide;
  const auto change = [&](const SmoothBody::Widths& widths) {
    body.SetWidths(wide);
    const Eigen::MatrixXd before = body.Precision(zero);
    body.SetWidths(widths);
    return Eigen::MatrixXd(body.Precision(zero) - before);
  };
  const Eigen::MatrixXd field = change({wide.field / 2, wide.classes, wide.hands});
  EXPECT_EQ(field.topLeftCorner(modes + 1, modes + 1).norm(), 0);  // an even slope is not rough
  EXPECT_NEAR(field(modes + 1, modes + 1), 3 * std::pow(wide.field, -2), 1e-9);

  const Eigen::MatrixXd of_class = change({wide.field, 0.1, wide.hands});
  EXPECT_NEAR(of_class(classes, classes), 100 - std::pow(wide.classes, -2), 1e-9);
  EXPECT_EQ(of_class.bottomRightCorner(body.size() - hands, body.size() - hands).norm(), 0);

  // what controllers' springs share with the object's is held together: it costs nothing to move
  const Eigen::MatrixXd of_hands = change({wide.field, wide.classes, 0.1});
  Eigen::VectorXd together = zero, apart = zero;
  together.head(4).setConstant(0.2);
  apart[1] = 0.2;
  EXPECT_NEAR(together.dot(of_hands * together), 0, 1e-9);
  EXPECT_NEAR(apart.dot(of_hands * apart), 4, 1e-9);
  EXPECT_NEAR(of_hands(hands, hands), 100, 1e-9);
}

// At 60 frames a second 2,500 is no whole number of sub-steps a frame.
TEST(SmoothBody, NeverNeedsMoreSubstepsThanItMay) {
  for (double fps : {30.0, 50.0, 60.0, 7.0}) {
    for (double rate : {3000.0, 9000.0, 50000.0}) {
      const Rope rope(rate, fps);
      const SmoothBody body = rope.Body();
      const Eigen::VectorXd zero = Eigen::VectorXd::Zero(body.size());
      EXPECT_TRUE(body.IsLimited(zero));
      EXPECT_LE(RateOf(body.Apply(zero), fps), body.most_rate());
      EXPECT_GT(RateOf(body.Apply(zero), fps), 0.8 * body.most_rate());
      EXPECT_LE(body.most_rate(), kMostRate);
    }
  }
}

// Where the body is limited, dashpots are lowered: numbers like what was simulated have the loss
// time that it had, also where they are no longer limited.
TEST(SmoothBody, NumbersLikeASystemHaveItsLossTime) {
  const Rope rope(2000);
  const SmoothBody body = rope.Body();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(body.size());
  x[2] = x[3] = 3;  // of the loss time
  SpringMassSystem system = body.Apply(x);
  ASSERT_TRUE(body.IsLimited(x));
  const double loss_time = system.dashpot[0] / system.stiffness[0];
  ASSERT_LT(loss_time, 0.5 * body.factors().Apply(x).dashpot[0] / system.stiffness[0]);
  system.stiffness *= 0.3;
  system.dashpot *= 0.3;
  const SpringMassSystem like = body.Apply(body.NumbersLike(system, x));
  EXPECT_NEAR(like.dashpot[0] / like.stiffness[0] / loss_time, 1, 1e-9);
  EXPECT_NEAR(like.stiffness.mean() / system.stiffness.mean(), 1, 0.05);
}

TEST(SmoothBody, HandsApartHaveStiffnessesOfTheirOwn) {
  const Rope rope(1000);
  const SmoothBody body = rope.Body(true);
  const SpringClasses& classes = body.factors().classes();
  ASSERT_GT(classes.count, classes.lengths);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(body.size());
  x[body.factors().first_class() + classes.lengths] = -1;  // the nearest spring of each controller
  const Eigen::VectorXd ratio = body.Apply(x).stiffness.cwiseQuotient(rope.start.stiffness);
  for (int e = 0; e < rope.start.spring_count(); ++e) {
    const bool moved = classes.of_spring[e] == classes.lengths;
    EXPECT_TRUE(!moved || rope.start.IsControllerSpring(e));
    EXPECT_NEAR(ratio[e], moved ? std::exp(-1) : 1, 1e-12);
  }
}

// Springs of one body differ by 30 %; what they have in common is found in them again. There are
// many more springs than numbers.
TEST(SmoothBody, TheNearestOneHasWhatSpringsHaveInCommon) {
  const Rope rope(1000, 60, 60);
  const SmoothBody body = rope.Body();
  ASSERT_GT(rope.start.spring_count(), 6 * body.size());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(body.size());
  const int first = body.factors().first_class();
  for (int i = 0; i < body.factors().classes().count; ++i) x[first + i] = 0.4 * i - 0.5;
  const SpringMassSystem truth = body.Apply(x);
  SpringMassSystem single = truth;
  for (int e = 0; e < single.spring_count(); ++e)
    single.stiffness[e] *= std::exp(0.3 * std::sin(7 * e));
  single.dashpot = 0.01 * single.stiffness;
  single.drag = 1.5;
  const SpringMassSystem nearest = body.NearestTo(single);
  const auto error = [&](const SpringMassSystem& system) {
    return (system.stiffness.array() / truth.stiffness.array()).log().matrix().norm();
  };
  EXPECT_LT(error(nearest), 0.6 * error(single));
  EXPECT_LT(error(body.NearestTo(truth)), 0.1 * error(single));
  EXPECT_TRUE(nearest.dashpot.isApprox(0.01 * nearest.stiffness));
  EXPECT_EQ(nearest.drag, 1.5);
  EXPECT_EQ(nearest.rest_length, rope.start.rest_length);
}

}  // namespace
}  // namespace physpring
