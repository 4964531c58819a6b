// SPDX-License-Identifier: Apache-2.0
#include "rollout/mujoco_log.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <thread>

#include "twin/error.h"

namespace physpring {
namespace {

TEST(CatchMujoco, ReturnsWarnings) {
  const std::vector<std::string> warnings = CatchMujoco([] {
    mju_warning("first");
    mju_warning("second\nline");
  });
  EXPECT_EQ(warnings, (std::vector<std::string>{"first", "second; line"}));
}

TEST(CatchMujoco, ThrowsErrors) {
  try {
    CatchMujoco([] { mju_error("no such thing"); });
    FAIL() << "no Error";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "MuJoCo: no such thing");
  }
}

TEST(CatchMujoco, WorksAgainAfterAnError) {
  EXPECT_THROW(CatchMujoco([] { mju_error("once"); }), Error);
  EXPECT_EQ(CatchMujoco([] { mju_warning("then"); }), std::vector<std::string>{"then"});
}

TEST(CatchMujoco, KeepsThreadsApart) {
  std::vector<std::string> theirs;
  const std::vector<std::string> ours = CatchMujoco([&theirs] {
    std::thread([&theirs] { theirs = CatchMujoco([] { mju_warning("theirs"); }); }).join();
    mju_warning("ours");
  });
  EXPECT_EQ(ours, std::vector<std::string>{"ours"});
  EXPECT_EQ(theirs, std::vector<std::string>{"theirs"});
}

}  // namespace
}  // namespace physpring
