// SPDX-License-Identifier: Apache-2.0
#include "twin/output_lock.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "tests/support/file_damage.h"
#include "tests/support/temporary_folder.h"

namespace physpring {
namespace {

class OutputLockTest : public testing::Test {
 protected:
  std::string ErrorOfLocking(const std::string& output) const {
    return ErrorOf(output, [&] { const OutputLock second(output); });
  }

  TemporaryFolder folder_;
  std::string file_ = folder_.File("rope.twin.npz");
  const std::string taken_ =
      ": another physpring is writing it; wait for its end, or choose another output";
};

TEST_F(OutputLockTest, IsHeldByOneOnly) {
  const OutputLock first(file_);
  EXPECT_EQ(ErrorOfLocking(file_), file_ + taken_);
  const OutputLock other(folder_.File("other.npz"));
}

TEST_F(OutputLockTest, LeavesNothing) {
  { const OutputLock lock(file_); }
  { const OutputLock lock(folder_.path()); }
  EXPECT_EQ(folder_.count(), 0);
}

TEST_F(OutputLockTest, OfAKilledRunKeepsNobodyOut) {
  std::ofstream(file_ + ".lock") << "";
  { const OutputLock lock(file_); }
  EXPECT_EQ(folder_.count(), 0);
}

TEST_F(OutputLockTest, IsOneForAllNamesOfAnOutput) {
  std::ofstream(file_) << "old";
  const std::string link = folder_.File("link.npz"), folder_link = folder_.File("folder");
  std::filesystem::create_symlink(file_, link);
  std::filesystem::create_directory_symlink(folder_.path(), folder_link);
  const OutputLock lock(file_), folder_lock(folder_.path() + "/");
  EXPECT_EQ(ErrorOfLocking(link), link + taken_);
  EXPECT_EQ(ErrorOfLocking(folder_link + "/rope.twin.npz"),
            folder_link + "/rope.twin.npz" + taken_);
  EXPECT_EQ(ErrorOfLocking(folder_link), folder_link + taken_);
}

TEST_F(OutputLockTest, NeedsAFolderThatIsThere) {
  const std::string absent = folder_.File("absent/rope.npz");
  EXPECT_EQ(ErrorOfLocking(absent), absent + ": cannot be locked: No such file or directory");
}

TEST_F(OutputLockTest, IsNotNeededForADevice) { const OutputLock lock("/dev/null"); }

}  // namespace
}  // namespace physpring
