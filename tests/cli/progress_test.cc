// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

TEST(FormatDuration, UsesTwoUnitsAtMost) {
  EXPECT_EQ(FormatDuration(0.26), "0.3 s");
  EXPECT_EQ(FormatDuration(12.4), "12 s");
  EXPECT_EQ(FormatDuration(59.7), "1 min 0 s");
  EXPECT_EQ(FormatDuration(200), "3 min 20 s");
  EXPECT_EQ(FormatDuration(7500), "2 h 5 min");
}

TEST(FormatProgress, DrawsABarAsWideAsTheTerminal) {
  EXPECT_EQ(FormatProgress(0.5, 65, "pass 3", 80),
            "[##########..........]  50 %, 1 min 5 s left, pass 3");
  EXPECT_EQ(FormatProgress(1, 0, "a long status that does not fit", 40).size(), 40u);
}

TEST(FormatProgress, IsPlainWithoutATerminal) {
  EXPECT_EQ(FormatProgress(0.123, 5, "pass 3", 0), " 12 %, 5.0 s left, pass 3");
}

TEST(FormatProgress, LeavesOutATimeThatIsNotKnown) {
  EXPECT_EQ(FormatProgress(0, -1, "pass 3", 0), "  0 %, pass 3");
}

}  // namespace
}  // namespace physpring
