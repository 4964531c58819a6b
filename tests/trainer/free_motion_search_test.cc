// SPDX-License-Identifier: Apache-2.0
#include "trainer/free_motion_search.h"

#include <gtest/gtest.h>

#include "tests/support/swung_chain.h"
#include "twin/error.h"

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
  static std::map<std::string, NpzArray> Saved(const FreeMotionSearch& search) {
    StateArrays arrays;
    search.Save(&arrays);
    return arrays;
  }
  static void ExpectSame(const FreeMotionSearch& a, const FreeMotionSearch& b) {
    const StateArrays x = Saved(a), y = Saved(b);
    ASSERT_EQ(x.size(), y.size());
    for (const auto& [name, array] : x) EXPECT_EQ(array.data, y.at(name).data) << name;
  }

  std::vector<int> WholeBody() const {
    return chain_.model.Factors(chain_.recording).WholeBodyEntries();
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
  second.Load(Saved(first));
  while (!second.done()) Step(&second, 2);
  while (!whole.done()) Step(&whole);
  ExpectSame(whole, second);
  EXPECT_EQ(whole.BestFactors(), second.BestFactors());
  FreeMotionSearch other(Eigen::VectorXd::Zero(3), {0, 1}, 6, 1);
  EXPECT_THROW(other.Load(Saved(first)), Error);
}

}  // namespace
}  // namespace physpring
