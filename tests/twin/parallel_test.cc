// SPDX-License-Identifier: Apache-2.0
#include "twin/parallel.h"

#include <gtest/gtest.h>

#include <atomic>

#include "tests/support/small_twin.h"
#include "twin/predict.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

// Takes the wish back at the end of a test.
class StopRequest : public testing::Test {
 protected:
  ~StopRequest() override { RequestStop(false); }
};

TEST_F(StopRequest, EndsParallelWorkAfterTheItemsThatRun) {
  std::atomic<int> begun{0};
  const auto work = [&](int) {
    ++begun;
    RequestStop(true);
  };
  EXPECT_THROW(ParallelFor(1000, 2, work), Stopped);
  EXPECT_LE(begun, 2);
}

TEST_F(StopRequest, EndsARolloutWithinAFrame) {
  const Twin twin = SmallTwin(1);
  const Recording recording = RecordingOfMotion(twin, 4);
  RequestStop(true);
  EXPECT_THROW(Predict(twin, 0, recording, {}), Stopped);
}

TEST_F(StopRequest, ThatWasTakenBackStopsNothing) {
  RequestStop(true);
  RequestStop(false);
  int done = 0;
  ParallelFor(3, 1, [&](int) { ++done; });
  EXPECT_EQ(done, 3);
}

}  // namespace
}  // namespace physpring
