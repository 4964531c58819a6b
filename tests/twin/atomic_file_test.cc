// SPDX-License-Identifier: Apache-2.0
#include "twin/atomic_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "tests/support/file_damage.h"
#include "tests/support/temporary_folder.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  std::string ErrorOfWriting(const std::string& path, const std::string& bytes) {
    return ErrorOf(path, [&] { WriteFileAtomically(path, bytes); });
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.File("report.json");
};

TEST_F(AtomicFile, ReplacesWhatWasThere) {
  WriteFileAtomically(path_, "first");
  WriteFileAtomically(path_, std::string("sec\0nd", 6));
  EXPECT_EQ(ReadFile(path_), std::string("sec\0nd", 6));
  EXPECT_EQ(folder_.count(), 1);
}

TEST_F(AtomicFile, IsWrittenInTheCurrentFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  WriteFileAtomically("report.json", "here");
  fs::current_path(before);
  EXPECT_EQ(ReadFile(path_), "here");
}

TEST_F(AtomicFile, HasThePermissionsOfANewFile) {
  const mode_t mask = umask(027);
  WriteFileAtomically(path_, "x");
  umask(mask);
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms(0640));
}

// A limit on the size of files is met as a full disk is: in the middle of writing.
TEST_F(AtomicFile, KeepsTheOldFileWhenTheDiskIsFull) {
  WriteFileAtomically(path_, "old");
  rlimit unlimited{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
  const rlimit limited{1000, unlimited.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limited), 0);
  const std::string error = ErrorOfWriting(path_, std::string(5000, 'x'));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(error, path_ + ": cannot be written: File too large");
  EXPECT_EQ(ReadFile(path_), "old");
  EXPECT_EQ(folder_.count(), 1);
}

TEST_F(AtomicFile, ReportsAFullDevice) {
  EXPECT_EQ(ErrorOfWriting("/dev/full", "x"),
            "/dev/full: cannot be written: No space left on device");
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(AtomicFile, LeavesNothingInAFolderThatIsNotWritable) {
  WriteFileAtomically(path_, "old");
  fs::permissions(folder_.path(), fs::perms(0555));
  const bool superuser = geteuid() == 0;  // may write to every folder
  constexpr uid_t kNobody = 65534;
  ASSERT_TRUE(!superuser || seteuid(kNobody) == 0);
  const std::string error = ErrorOfWriting(path_, "new");
  ASSERT_TRUE(!superuser || seteuid(0) == 0);
  fs::permissions(folder_.path(), fs::perms(0755));
  EXPECT_EQ(error, path_ + ": cannot be written: Permission denied");
  EXPECT_EQ(ReadFile(path_), "old");
  EXPECT_EQ(folder_.count(), 1);
}

TEST_F(AtomicFile, NeedsAFolderThatIsThere) {
  const std::string absent = folder_.File("absent/report.json");
  EXPECT_EQ(ErrorOfWriting(absent, "x"), absent + ": cannot be written: No such file or directory");
  EXPECT_EQ(ErrorOfWriting(folder_.path(), "x"),
            folder_.path() + ": cannot be written: Is a directory");
  EXPECT_EQ(folder_.count(), 0);
}

TEST_F(AtomicFile, FollowsALink) {
  const std::string link = folder_.File("latest.json");
  WriteFileAtomically(path_, "old");
  fs::create_symlink(path_, link);
  WriteFileAtomically(link, "new");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(ReadFile(path_), "new");
}

TEST_F(AtomicFile, WritesToAPipeDirectly) {
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  const int reader = open(path_.c_str(), O_RDONLY | O_NONBLOCK);
  WriteFileAtomically(path_, "through");
  char received[16] = {};
  EXPECT_EQ(read(reader, received, sizeof received), 7);
  close(reader);
  EXPECT_STREQ(received, "through");
  EXPECT_TRUE(fs::is_fifo(path_));
}

TEST_F(AtomicFile, IsNotReadFromAPipe) {
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  const std::string error =
      path_ + ": cannot be read: is a pipe or a device; copy what it holds to a file first";
  EXPECT_EQ(ErrorOf(path_, [this] { ReadFile(path_); }), error);
  EXPECT_EQ(ErrorOf(path_, [this] { ExpectRegularFile(path_); }), error);
}

TEST_F(AtomicFile, ReadsNoMoreThanTheLimit) {
  WriteFileAtomically(path_, "12345");
  EXPECT_EQ(ReadFile(path_, 5), "12345");
  EXPECT_EQ(ErrorOf(path_, [this] { ReadFile(path_, 4); }),
            path_ + ": is larger than 4 bytes, the most that is read");
}

}  // namespace
}  // namespace physpring
