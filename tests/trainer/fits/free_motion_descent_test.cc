// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/free_motion_descent.h"

#include <gtest/gtest.h>

#include "tests/support/swung_chain.h"

namespace physpring {
namespace {

constexpr int kFrames = 16;

class FreeMotionDescends : public testing::Test {
 protected:
  std::vector<int> Shape() const {
    return chain_.model.ParametersOf(chain_.recording).AlongBodyEntries();
  }
  FreeMotionDescent Step(const FreeMotionDescent& state, int threads = 1) const {
    TrainOptions options;
    options.threads = threads;
    return DescendFreeMotions(chain_.model, Shape(), {{&chain_.recording, kFrames}}, options,
                              state);
  }

  SwungChain chain_ = SwungChain(kFrames);
  FreeMotionDescent off_ = {chain_.Off(Shape())};
};

TEST_F(FreeMotionDescends, ToTheShapeThatWasMeasured) {
  ASSERT_EQ(Shape().size(), 16U);  // moments up and to the side at eight places
  const FreeMotionDescent first = Step(off_);
  FreeMotionDescent state = first;
  for (int i = 0; i < 5; ++i) {
    const FreeMotionDescent next = Step(state);
    EXPECT_LE(next.error, state.error);
    state = next;
  }
  EXPECT_LT(state.error, 0.6 * first.error);
  EXPECT_LT(state.factors.norm(), off_.factors.norm());
}

TEST_F(FreeMotionDescends, NeverFromTheBest) {
  const FreeMotionDescent state = Step({chain_.model.factors});
  EXPECT_TRUE(state.converged);
  EXPECT_TRUE(state.factors.isZero());
  EXPECT_LT(state.error, 1e-8);
}

TEST_F(FreeMotionDescends, AlikeWithAnyNumberOfThreads) {
  const FreeMotionDescent one = Step(off_, 1), two = Step(off_, 2);
  EXPECT_EQ(one.factors, two.factors);
  EXPECT_EQ(one.error, two.error);
}

}  // namespace
}  // namespace physpring
