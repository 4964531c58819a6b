// SPDX-License-Identifier: Apache-2.0
#include "exporter/folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

std::string MessageOf(const std::string& path, const std::map<std::string, std::string>& files,
                      bool force) {
  try {
    WriteFolder(path, files, force);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Folder, HoldsTheFiles) {
  const TemporaryFolder folder;
  WriteFolder(folder.File("a/b/"), {{"x.xml", "one"}, {"y.md", "two"}}, false);
  EXPECT_EQ(ReadFile(folder.File("a/b/x.xml")), "one");
  EXPECT_EQ(ReadFile(folder.File("a/b/y.md")), "two");
}

TEST(Folder, LeavesNothingElse) {
  const TemporaryFolder folder;
  WriteFolder(folder.File("b"), {{"x", "one"}}, false);
  WriteFolder(folder.File("b"), {{"x", "two"}}, true);
  EXPECT_EQ(folder.count(), 1);
}

TEST(Folder, IsNotOverwrittenUnlessForced) {
  const TemporaryFolder folder;
  const std::string path = folder.File("b");
  WriteFolder(path, {{"x", "one"}, {"y", "one"}}, false);
  EXPECT_EQ(MessageOf(path, {{"x", "two"}}, false), path + ": exists; --force overwrites");
  EXPECT_EQ(ReadFile(path + "/x"), "one");
  WriteFolder(path, {{"x", "two"}}, true);
  EXPECT_EQ(ReadFile(path + "/x"), "two");
  EXPECT_EQ(ReadFile(path + "/y"), "one");
}

TEST(Folder, LosesLevelsThatAreNotExportedAgain) {
  const TemporaryFolder folder;
  WriteFolder(folder.path(), {{"level0.xml", "0"}, {"scene_level1.xml", "1"}, {"my.xml", "2"}},
              false);
  WriteFolder(folder.path(), {{"level0.xml", "3"}}, true);
  EXPECT_EQ(ReadFile(folder.File("level0.xml")), "3");
  EXPECT_EQ(ReadFile(folder.File("my.xml")), "2");
  EXPECT_FALSE(std::filesystem::exists(folder.File("scene_level1.xml")));
}

// Folders of samples come and go as a whole; what else is in the folder stays.
TEST(Folder, ReplacesFoldersOfSamples) {
  const TemporaryFolder folder;
  const std::string path = folder.File("b");
  EXPECT_EQ(SampleFolder(7), "sample_0007");
  WriteFolder(path,
              {{"README.md", "a"},
               {"sample_0000/level0.xml", "b"},
               {"sample_0000/level1.xml", "c"},
               {"sample_0001/scene.xml", "d"}},
              false);
  EXPECT_EQ(ReadFile(path + "/sample_0000/level1.xml"), "c");
  WriteFolder(path, {{"README.md", "e"}, {"sample_0000/level0.xml", "f"}}, true);
  EXPECT_EQ(ReadFile(path + "/sample_0000/level0.xml"), "f");
  EXPECT_FALSE(std::filesystem::exists(path + "/sample_0000/level1.xml"));
  EXPECT_FALSE(std::filesystem::exists(path + "/sample_0001"));
  std::filesystem::create_directory(path + "/z");  // no file can take its place: all stays
  const std::map<std::string, std::string> files = {
      {"sample_0000/level0.xml", "g"}, {"sample_0001/level0.xml", "h"}, {"z", "i"}};
  EXPECT_NE(MessageOf(path, files, true), "");
  EXPECT_EQ(ReadFile(path + "/sample_0000/level0.xml"), "f");
  EXPECT_FALSE(std::filesystem::exists(path + "/sample_0001"));
  EXPECT_EQ(folder.count(), 1);
}

TEST(Folder, LeavesAloneWhatNoExportMade) {
  const TemporaryFolder folder;
  const std::string path = folder.File("b"), notes = path + "/sample_0003/notes.txt";
  WriteFolder(path, {{"README.md", "a"}, {"sample_0003/level0.xml", "b"}}, false);
  std::ofstream(notes) << "mine";
  WriteFolder(path, {{"README.md", "c"}}, true);
  EXPECT_EQ(ReadFile(notes), "mine");
  EXPECT_EQ(MessageOf(path, {{"README.md", "d"}, {"sample_0003/level0.xml", "e"}}, true),
            path + "/sample_0003: is in the way of a sample, and no export made it");
  EXPECT_EQ(ReadFile(path + "/README.md"), "c");
  EXPECT_EQ(ReadFile(path + "/sample_0003/level0.xml"), "b");
  std::ofstream(path + "/sample_0004") << "mine";
  EXPECT_NE(MessageOf(path, {{"sample_0004/level0.xml", "e"}}, true), "");
  EXPECT_EQ(ReadFile(path + "/sample_0004"), "mine");
  EXPECT_EQ(folder.count(), 1);
}

TEST(Folder, FillsAnEmptyOne) {
  const TemporaryFolder folder;
  WriteFolder(folder.path(), {{"x", "one"}}, false);
  EXPECT_EQ(ReadFile(folder.File("x")), "one");
}

TEST(Folder, FailsWithoutATrace) {
  const TemporaryFolder folder;
  const std::string path = folder.File("b");
  // no file has so long a name
  EXPECT_NE(MessageOf(path, {{"x", "one"}, {"z/" + std::string(300, 'y'), "two"}}, false), "");
  EXPECT_EQ(folder.count(), 0);
}

// The last of three files cannot take its place, because a folder has it.
TEST(Folder, KeepsAllOldFilesWhenOneCannotBeReplaced) {
  const TemporaryFolder folder;
  const std::string path = folder.File("b");
  WriteFolder(path, {{"w", "old"}}, false);
  std::filesystem::create_directory(path + "/z");
  const std::string error = MessageOf(path, {{"v", "new"}, {"w", "new"}, {"z", "new"}}, true);
  EXPECT_EQ(error, path + ": cannot be written: Is a directory");
  EXPECT_EQ(ReadFile(path + "/w"), "old");
  EXPECT_FALSE(std::filesystem::exists(path + "/v"));
  EXPECT_EQ(folder.count(), 1);
}

TEST(Folder, RemovesWhatAKilledExportLeft) {
  const TemporaryFolder folder;
  for (const char* name : {".b.export-a1B2c3", ".c.export-a1B2c3", ".b.export-long-name"}) {
    std::filesystem::create_directory(folder.File(name));
    std::ofstream(folder.File(name) + "/x") << "half";
  }
  WriteFolder(folder.File("b"), {{"x", "one"}}, false);
  EXPECT_FALSE(std::filesystem::exists(folder.File(".b.export-a1B2c3")));
  EXPECT_EQ(folder.count(), 3);
}

TEST(Folder, IsNotAFile) {
  const TemporaryFolder folder;
  std::ofstream(folder.File("b")) << "text";
  EXPECT_EQ(MessageOf(folder.File("b"), {{"x", "one"}}, true),
            folder.File("b") + ": is not a folder");
  EXPECT_NE(MessageOf(folder.File("b/c"), {{"x", "one"}}, true), "");
}

}  // namespace
}  // namespace physpring
