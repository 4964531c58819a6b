// SPDX-License-Identifier: Apache-2.0
// The loop where nothing is left to explain; diagnosis_test.cc lets it find something.
#include "diagnosis/find_effects.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/swung_rope.h"
#include "trainer/bodies/start_system.h"

namespace physpring {
namespace {

constexpr int kFrames = 70;  // 45 to 59 are held out
constexpr double kLoud = 1;  // m: more noise than there is error

class NothingToFind : public testing::Test {
 protected:
  NothingToFind() : recording_(SwungRope(6, kFrames)) {
    recording_.train_frames = kFrames;
    body_.base = MakeStartSystem(recording_, {});
    body_.kind = DiagnosisBody::Kind::kTrusted;
    SpringMassSystem other = body_.base;
    other.stiffness *= 0.3;
    MoveAs(other, true, &recording_);
  }

  std::optional<Findings> Find(const std::optional<Verdict>& trained) const {
    const Fitting fitting({body_}, {HoldOutFrames(recording_)}, 1);
    return FindEffects(fitting, kLoud, {}, {}, {}, trained);
  }

  Recording recording_;
  DiagnosisBody body_;
};

TEST_F(NothingToFind, LooksForNoEffect) {
  const auto findings = Find({});
  ASSERT_TRUE(findings);
  ASSERT_EQ(findings->rankings.size(), 1U);
  EXPECT_TRUE(findings->rankings[0].empty());
  EXPECT_TRUE(findings->accepted.system.effects.empty());
  EXPECT_EQ(findings->before.held, findings->accepted.held);
}

TEST_F(NothingToFind, TakesTheTwinAsItCameOnlyIfItPredictsBetter) {
  Verdict trained;
  trained.provenance = Verdict::Provenance::kTraining;
  trained.track.held = 0;
  EXPECT_EQ(Find(trained)->before.provenance, Verdict::Provenance::kTraining);
  trained.track.held = kLoud;
  EXPECT_EQ(Find(trained)->before.provenance, Verdict::Provenance::kRefit);
}

TEST_F(NothingToFind, SaysWhenTheModelDiverges) {
  body_.base.stiffness *= std::numeric_limits<double>::infinity();
  EXPECT_FALSE(Find({}));
}

}  // namespace
}  // namespace physpring
