// SPDX-License-Identifier: Apache-2.0
#include "twin/draft_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"

namespace physpring {
namespace {

class DraftFileTest : public testing::Test {
 protected:
  std::string File(const std::string& name) const { return folder_.File(name); }
  // As a killed program leaves it: nobody has locked it.
  void Leave(const std::string& name) const { std::ofstream(File(name)) << "half"; }
  bool IsThere(const std::string& name) const { return std::filesystem::exists(File(name)); }

  TemporaryFolder folder_;
};

TEST_F(DraftFileTest, WhatAKilledWriterLeftIsRemovedByTheNext) {
  Leave("a.npz.12-0.tmp");
  Leave("a.npz.12-34.tmp.npz");
  ExpectFileWritable(File("a.npz"));
  EXPECT_EQ(folder_.count(), 0);
}

TEST_F(DraftFileTest, FilesOfOthersStay) {
  const std::vector<std::string> others = {"b.npz.12-0.tmp",     "a.npz.tmp",
                                           "a.npz.x-0.tmp",      "a.npz.12-0.tmp.xm",
                                           "a.npz.12-0.tmp.bak", "a.npz.12-0"};
  for (const std::string& name : others) Leave(name);
  RemoveAbandonedDrafts(File("a.npz"));
  for (const std::string& name : others) EXPECT_TRUE(IsThere(name)) << name;
}

TEST_F(DraftFileTest, OneThatIsBeingWrittenStays) {
  DraftFile draft(File("a.npz"));
  ASSERT_TRUE(draft.Write("whole"));
  RemoveAbandonedDrafts(File("a.npz"));
  EXPECT_TRUE(draft.Rename());
  EXPECT_EQ(ReadFile(File("a.npz")), "whole");
}

TEST_F(DraftFileTest, IsGoneUnlessItWasRenamed) {
  { const DraftFile draft(File("a.npz"), ".npz"); }
  EXPECT_EQ(folder_.count(), 0);
}

TEST_F(DraftFileTest, AllOfAFolderAreRemovedAtOnce) {
  Leave("a.npz.12-0.tmp");
  Leave("b.json.7-1.tmp");
  Leave("c.json");
  RemoveAbandonedDraftsIn(folder_.path());
  EXPECT_EQ(folder_.count(), 1);
}

}  // namespace
}  // namespace physpring
