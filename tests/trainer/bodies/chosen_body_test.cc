// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/chosen_body.h"

#include <gtest/gtest.h>

#include "tests/support/swung_sheet.h"
#include "trainer/bodies/candidates.h"

namespace physpring {
namespace {

// More springs are in other classes of length, and often in more or fewer of them: what was fitted
// to all springs stays as it was.
TEST(ChosenBody, KeepsItsCommonFactorsWithSpringsBeyondItsRadius) {
  int of_other_size = 0;
  for (double jitter : {0.02, 0.05, 0.1, 0.2}) {
    const Recording recording = Jittered(SwungSheet(5), jitter);
    for (int neighbours = 6; neighbours < 16; ++neighbours) {
      TrainOptions options;
      options.neighbours = {neighbours};
      ChosenBody chosen{CandidateBodies(recording, options).at(0), 8, {}, {}};
      const Parameters common = chosen.ParametersOf(recording);
      chosen.factors = Eigen::VectorXd::LinSpaced(common.size(), 0.1, 0.5);
      const ChosenBody more = chosen.WithSoftSprings(recording);
      ASSERT_EQ(more.factors.size(), more.ParametersOf(recording).size()) << neighbours;
      EXPECT_EQ(more.factors.head(common.first_class()), chosen.factors.head(common.first_class()));
      EXPECT_EQ(more.System(recording).drag, chosen.System(recording).drag);
      if (more.factors.size() != chosen.factors.size()) ++of_other_size;
    }
  }
  EXPECT_GT(of_other_size, 0);
}

}  // namespace
}  // namespace physpring
