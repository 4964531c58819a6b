// SPDX-License-Identifier: Apache-2.0
#include "jobs/remarks.h"

#include <gtest/gtest.h>

namespace physpring {
namespace {

using Lines = std::vector<std::string>;

TEST(Remarks, AreSaidOnceOfFilesAlike) {
  EXPECT_EQ(JoinAlike({"a.npz: no mass", "a.npz: 3 points", "b.npz: no mass", "c.npz: no mass"}),
            (Lines{"a.npz and 2 more: no mass", "a.npz: 3 points"}));
  EXPECT_EQ(JoinAlike({"of no file", "b: 1", "b: 2"}), (Lines{"of no file", "b: 1", "b: 2"}));
  EXPECT_EQ(JoinAlike({"a: 1", "a: 1", "b: 1"}), (Lines{"a and 1 more: 1"}));  // one file is one
  EXPECT_EQ(JoinAlike({}), Lines());
}

}  // namespace
}  // namespace physpring
