// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/free_motion_search.h"

#include <gtest/gtest.h>

#include "tests/support/swung_chain.h"
#include "trainer/journal/packing.h"

namespace physpring {
namespace {

constexpr int kFrames = 16;

class FreeMotions : public testing::Test {
 protected:
  FreeMotionSearch Search(const Eigen::VectorXd& factors, int generations) const {
    return {factors, WholeBody(), generations, 1};
  }
  void Step(FreeMotionSearch* search, int threads = 1) const {
    TrainOptions options;
    options.threads = threads;
    search->Step(chain_.model, {{&chain_.recording, kFrames}}, options);
  }
  std::vector<int> WholeBody() const {
    return chain_.model.ParametersOf(chain_.recording).WholeBodyEntries();
  }

  SwungChain chain_ = SwungChain(kFrames);
  Eigen::VectorXd off_ = chain_.Off(WholeBody());
};

TEST_F(FreeMotions, ComeNearerToWhatWasMeasured) {
  FreeMotionSearch search = Search(off_, 40);
  Step(&search);
  const double early = search.best_error();
  while (!search.done()) Step(&search);
  EXPECT_LT(search.best_error(), 0.5 * early);
  EXPECT_EQ(search.Progress(), 1);
}

TEST_F(FreeMotions, NeverGetWorseThanTheStart) {
  FreeMotionSearch search = Search(Eigen::VectorXd::Zero(off_.size()), 2);  // nothing is better
  while (!search.done()) Step(&search);
  EXPECT_LT(search.best_error(), 1e-8);
  EXPECT_TRUE(search.BestFactors().isZero());
}

TEST_F(FreeMotions, EndWhereNothingIsGained) {
  FreeMotionSearch search = Search(Eigen::VectorXd::Zero(off_.size()), 0);
  int generations = 0;
  for (; !search.done(); ++generations) {
    EXPECT_LT(search.Progress(), 1);
    Step(&search);
  }
  EXPECT_EQ(generations, 10);
}

TEST_F(FreeMotions, GoOnFromASavedStateWithAnyNumberOfThreads) {
  FreeMotionSearch whole = Search(off_, 6), first = whole;
  for (int i = 0; i < 3; ++i) Step(&first, 2);
  FreeMotionSearch second = Search(Eigen::VectorXd::Zero(off_.size()), 6);
  Unpack(Pack(first), &second);
  while (!second.done()) Step(&second, 2);
  while (!whole.done()) Step(&whole);
  EXPECT_EQ(Pack(whole), Pack(second));
  EXPECT_EQ(whole.BestFactors(), second.BestFactors());
}

}  // namespace
}  // namespace physpring
