// SPDX-License-Identifier: Apache-2.0
#include "twin/dataset.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "tests/support/development_data.h"
#include "tests/support/file_damage.h"
#include "tests/support/temporary_folder.h"
#include "twin/atomic_file.h"
#include "twin/error.h"

namespace physpring {
namespace {

// A folder with three recordings and a dataset.json that a test writes.
class Dataset : public testing::Test {
 protected:
  Dataset() {
    for (const char* name : {"a.npz", "b.npz", "c.npz"}) Overwrite(folder_.File(name), "");
    Overwrite(json_, R"({"name": "cable", "published_l1_m": {"DER": 0.0196}, "recordings": [
        {"file": "b.npz", "role": "fit", "continuous_recording": 3},
        {"file": "a.npz", "role": "fit"},
        {"file": "c.npz", "role": "heldout", "continuous_recording": 0}]})");
  }

  TemporaryFolder folder_;
  std::string json_ = folder_.File("dataset.json");
};

TEST_F(Dataset, StandsForItsRecordingsOfARole) {
  const std::vector<RecordingEntry> fit = ListRecordings({folder_.path()}, Role::kFit);
  ASSERT_EQ(fit.size(), 2u);
  EXPECT_EQ(fit[0].path, folder_.File("b.npz"));
  EXPECT_EQ(fit[1].path, folder_.File("a.npz"));
  EXPECT_FALSE(fit[0].heldout);
  EXPECT_EQ(fit[0].continuous_recording, 3);
  EXPECT_EQ(fit[1].continuous_recording, -1);
  EXPECT_TRUE(fit[0].published_l1);

  const std::vector<RecordingEntry> heldout =
      ListRecordings({folder_.path() + "/"}, Role::kHeldout);
  ASSERT_EQ(heldout.size(), 1u);
  EXPECT_EQ(std::filesystem::path(heldout[0].path).filename(), "c.npz");
  EXPECT_TRUE(heldout[0].heldout);
}

// One recording may belong to several data sets.
TEST_F(Dataset, TakesRecordingsOfOtherFolders) {
  const std::string set = folder_.File("set"), absolute = folder_.File("a.npz");
  std::filesystem::create_directory(set);
  Overwrite(set + "/dataset.json", R"({"recordings": [{"file": "../b.npz", "role": "fit"},
      {"file": ")" + absolute + R"(", "role": "fit"}]})");
  const std::vector<RecordingEntry> fit = ListRecordings({set}, Role::kFit);
  ASSERT_EQ(fit.size(), 2u);
  EXPECT_TRUE(std::filesystem::equivalent(fit[0].path, folder_.File("b.npz")));
  EXPECT_EQ(fit[1].path, absolute);
}

TEST_F(Dataset, MayBeNamedByItsFile) {
  const std::vector<RecordingEntry> heldout = ListRecordings({json_}, Role::kHeldout);
  ASSERT_EQ(heldout.size(), 1u);
  EXPECT_EQ(heldout[0].path, folder_.File("c.npz"));
}

TEST_F(Dataset, SaysTheSameOfAFileGivenByItself) {
  const std::vector<RecordingEntry> listed = ListRecordings({folder_.File("c.npz")}, Role::kFit);
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_TRUE(listed[0].heldout);
  EXPECT_TRUE(listed[0].published_l1);
  EXPECT_EQ(listed[0].continuous_recording, 0);
}

TEST_F(Dataset, IsNotNeededForFiles) {
  std::filesystem::remove(json_);
  const std::vector<RecordingEntry> listed =
      ListRecordings({folder_.File("b.npz"), folder_.File("a.npz")}, Role::kFit);
  ASSERT_EQ(listed.size(), 2u);
  EXPECT_EQ(listed[0].path, folder_.File("b.npz"));
  EXPECT_FALSE(listed[0].heldout);
  EXPECT_FALSE(listed[0].published_l1);
  EXPECT_EQ(listed[0].continuous_recording, -1);
}

TEST_F(Dataset, MalformedIsRefused) {
  const std::vector<std::pair<const char*, const char*>> cases{
      {"", "is not JSON"},
      {"{\"recordings\": [", "is not JSON"},
      {"[]", "is not a JSON object"},
      {"{}", "key 'recordings' is missing"},
      {R"({"recordings": {}})", "key 'recordings' holds '{}', expected an array of objects"},
      {R"({"recordings": ["a.npz"]})", "expected an array of objects"},
      {R"({"recordings": []})", "key 'recordings' has none of the role 'fit'"},
      {R"({"recordings": [{"role": "fit"}]})", "key 'recordings[0].file' is missing"},
      {R"({"recordings": [{"file": "a.npz"}]})", "key 'recordings[0].role' is missing"},
      {R"({"recordings": [{"file": 3, "role": "fit"}]})",
       "key 'recordings[0].file' holds '3', expected text"},
      {R"({"recordings": [{"file": "x\n.npz", "role": "fit"}]})",
       "key 'recordings[0].file' holds 'x?.npz', which is not there"},
      {R"({"recordings": [{"file": "a.npz", "role": "test"}]})",
       "key 'recordings[0].role' holds 'test', expected 'fit' or 'heldout'"},
      {R"({"recordings": [{"file": "a.npz", "role": "heldout"}]})",
       "key 'recordings' has none of the role 'fit'"},
      {R"({"recordings": [{"file": "a.npz", "role": "fit", "continuous_recording": 0.5}]})",
       "key 'recordings[0].continuous_recording' holds '0.5', expected a whole number"},
      {R"({"recordings": [{"file": "a.npz", "role": "fit", "continous_recording": 0}]})",
       "key 'recordings[0].continous_recording' is not known, expected only file, role"},
  };
  for (const auto& [json, message] : cases) {
    Overwrite(json_, json);
    const std::string error =
        ErrorOf(json_, [this] { ListRecordings({folder_.path()}, Role::kFit); });
    EXPECT_NE(error.find(message), std::string::npos) << error << ", expected " << message;
  }
}

TEST_F(Dataset, SurvivesRandomChanges) {
  std::mt19937 random(5);
  const std::string sound = ReadFile(json_);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string json = sound;
    for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
      json[random() % json.size()] = static_cast<char>(random());
    }
    Overwrite(json_, json);
    try {
      EXPECT_FALSE(ListRecordings({folder_.path()}, Role::kFit).empty());
    } catch (const Error& error) {
      ExpectOneLine(json_, error.what());
    }
  }
}

TEST_F(Dataset, NeedsItsFile) {
  std::filesystem::remove(json_);
  EXPECT_EQ(ErrorOf(json_, [this] { ListRecordings({folder_.path()}, Role::kFit); }),
            json_ + ": cannot be read: No such file or directory");
  const std::string absent = folder_.File("absent.npz");
  EXPECT_NE(ErrorOf(absent, [&] { ListRecordings({absent}, Role::kFit); }).find("does not exist"),
            std::string::npos);
}

TEST_F(Dataset, CountsARecordingOnce) {
  const std::string a = std::filesystem::canonical(folder_.File("a.npz")).string();
  EXPECT_NE(ErrorOf(a,
                    [&] {
                      ListRecordings({folder_.path(), a}, Role::kFit);
                    })
                .find("is given twice"),
            std::string::npos);
}

TEST(DevelopmentDatasets, AreListed) {
  if (DevelopmentData().empty()) GTEST_SKIP() << kNoDevelopmentData;
  const std::string folder = DevelopmentData() + "/cables/DLO1";
  EXPECT_EQ(ListRecordings({folder}, Role::kFit).size(), 56u);
  EXPECT_EQ(ListRecordings({folder}, Role::kHeldout).size(), 14u);
}

}  // namespace
}  // namespace physpring
