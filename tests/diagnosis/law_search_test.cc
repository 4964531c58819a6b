// SPDX-License-Identifier: Apache-2.0
// Swung ropes that a law moves, or nothing.
#include "diagnosis/law_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

constexpr int kFrames = 100;

// The mean distance [m] that noise of each coordinate makes of a point, about.
double FloorOf(double noise) { return 1.6 * noise; }

// The values of a term.
EffectValues Term(int acts_on, int in_time, double rate, const Eigen::Vector3d& a) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(9);
  values.head(3) << acts_on, in_time, rate;
  values.segment<3>(3) = a;
  return {"custom", values};
}

class LawSearch : public testing::Test {
 protected:
  LawSearch() : recording_(SwungRope(6, kFrames)) {
    recording_.train_frames = kFrames;
    body_.base = MakeStartSystem(recording_, {});
    body_.kind = DiagnosisBody::Kind::kTrusted;
  }

  // The law of the rope that moves with these effects, measured with noise of that deviation, m.
  std::optional<Law> Find(const std::vector<EffectValues>& effects, double deviation = 2e-4) {
    SpringMassSystem system = body_.base;
    system.effects = effects;
    MoveAs(system, true, &recording_);
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, deviation);
    for (std::size_t frame = 1; frame < recording_.points.size(); ++frame) {
      for (double& value : recording_.points[frame].reshaped()) value += noise(random);
    }
    const Fitting fitting({body_}, {HoldOutFrames(recording_)}, 2);
    const auto without = fitting.Judge(fitting.Begin(0, {}));
    if (!without) return {};
    const DiagnosisOptions options;
    return FindLaw(InquiryOf(fitting, FloorOf(deviation), options), *without, without->descent, {});
  }

  Recording recording_;
  DiagnosisBody body_;
};

TEST_F(LawSearch, FindsAPeriodicPush) {
  const auto law = Find({Term(0, 3, 11, {0, 1.5, 0.5})});
  ASSERT_TRUE(law);
  ASSERT_EQ(law->terms, 1);
  const Eigen::VectorXd& values = law->verdict.system.effects.back().values;
  EXPECT_EQ(values[0], 0);
  EXPECT_EQ(values[1], 3);
  EXPECT_NEAR(values[2], 11, 0.3);
  EXPECT_NEAR(values.segment<3>(3).norm(), std::hypot(1.5, 0.5), 0.2);
  EXPECT_LT(law->verdict.track.held, 1.5 * FloorOf(2e-4));
}

TEST_F(LawSearch, FindsAStiffnessThatGrowsWithTheSquareOfTime) {
  const auto law = Find({Term(3, 2, 0, {0.3, 0, 0})}, 5e-5);
  ASSERT_TRUE(law);
  const Eigen::VectorXd& values = law->verdict.system.effects[0].values;
  EXPECT_EQ(values[0], 3);
  EXPECT_EQ(values[1], 2);
  EXPECT_NEAR(values[3], 0.3, 0.03);
}

TEST_F(LawSearch, FindsNoneInNoise) { EXPECT_FALSE(Find({})); }

}  // namespace
}  // namespace physpring
