// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/hanging_net.h"

#include <gtest/gtest.h>

#include "tests/support/interrupted_work.h"
#include "tests/support/plain_rope.h"
#include "trainer/bodies/candidates.h"
#include "trainer/bodies/factors.h"
#include "trainer/bodies/start_system.h"
#include "trainer/fits/dense_fit.h"
#include "twin/evaluate.h"

namespace physpring {
namespace {

constexpr double kHeavy = 0.045;  // kg, stretches the rope by 16 %

TEST(HangsAtRest, TellsARopeThatCarriesItselfFromOneThatIsSlack) {
  EXPECT_TRUE(HangsAtRest(HangingRope(kHeavy).Record()));
  PlainRope slack;
  slack.mass = kHeavy;
  EXPECT_FALSE(HangsAtRest(slack.Record())) << "it falls into its springs";
  Recording recording = HangingRope(kHeavy).Record();
  recording.rest_given = true;
  EXPECT_FALSE(HangsAtRest(recording)) << "its stress-free shape is known";
  recording = HangingRope(kHeavy).Record();
  recording.ground = Eigen::Vector4d(0, 0, 1, recording.start.row(2).minCoeff());
  EXPECT_FALSE(HangsAtRest(recording)) << "it lies on the ground";
}

// In a vertical chain a spring carries all that is below it.
TEST(StrainShares, OfAChainGrowWithTheWeightBelow) {
  PlainRope rope = HangingRope(kHeavy);
  rope.noise = 0;
  rope.frames = 2;
  const Recording recording = rope.Record();
  SpringMassSystem chain = MakeStartSystem(recording, {.max_neighbours = 1});
  std::erase_if(chain.springs, [](const auto& one) { return one[1] == 11 && one[0] != 0; });
  ASSERT_EQ(chain.spring_count(), 11);
  chain.rest_length = SpringLengths(chain.springs, chain.position, {});
  chain.stiffness = chain.rest_length.cwiseInverse();
  chain.dashpot = Eigen::VectorXd::Ones(11);
  const Eigen::VectorXd share = StrainShares(chain, recording.gravity);
  for (int e = 0; e < 11; ++e) {
    const auto [a, b] = chain.springs[e];
    const int below = b == 11 ? 11 : 11 - std::max(a, b);
    EXPECT_NEAR(share[e], below / 11.0, 0.01) << a << " " << b;
  }
}

TEST(RestRatio, HasTheSlopeAndTheInverseThatItSays) {
  for (double x : {-2.0, -0.51, -0.3, 0.0, 0.2, 3.0}) {
    EXPECT_NEAR((RestRatio(x + 1e-6) - RestRatio(x - 1e-6)) / 2e-6, RestRatioSlope(x), 1e-6) << x;
    EXPECT_NEAR(StrainOfRatio(RestRatio(x)), x, 1e-12);
    EXPECT_GT(RestRatio(x), 0);
  }
}

TEST(Candidates, OfARopeThatHangsHangToo) {
  int hang = 0;
  for (const Body& body : CandidateBodies(HangingRope(kHeavy).Record(), {})) {
    hang += body.strain.size() > 0;
  }
  EXPECT_GT(hang, 0);
  for (const Body& body : CandidateBodies(PlainRope().Record(), {})) {
    EXPECT_EQ(body.strain.size(), 0) << body.Label();
  }
}

// The slack rope's rest lengths come out, and later frames are predicted. (With frame 0 taken for
// the stress-free shape the error on them is several times as large.)
TEST(HangingNet, IsFoundByTheFit) {
  FitData data;
  data.recordings.push_back(HangingRope(kHeavy).Record());
  data.continuous_recording.push_back(-1);
  TrainOptions options;
  options.neighbours = {2};
  const Twin twin = RunToTheEnd([&](const Work& work) { return FitDense(data, options, work); });
  const SpringMassSystem& system = twin.levels[0].system;
  double between_neighbours = 0;
  int count = 0;
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    if (b != a + 1 || b > 10) continue;
    between_neighbours += system.rest_length[e];
    ++count;
  }
  ASSERT_GT(count, 5);
  EXPECT_NEAR(between_neighbours / count, 0.05, 0.0025);
  const RecordingResult result = Evaluate(twin, data.recordings[0], {});
  const auto later = MeansOverFrames(result.levels[0].lifted, 84, 120).track.value.value();
  EXPECT_LT(later, 0.008);
}

}  // namespace
}  // namespace physpring
