// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/diagnosis_recordings.h"

#include <gtest/gtest.h>

#include <string>

namespace physpring {
namespace {

// Recordings named after their run: "0", "0", "1", ...
FitData Runs(const std::vector<int>& run_of_each) {
  FitData data;
  for (int run : run_of_each) {
    Recording recording;
    recording.name = std::to_string(run);
    data.recordings.push_back(recording);
    data.continuous_recording.push_back(run);
  }
  return data;
}

std::vector<std::string> Names(const std::vector<Recording>& recordings) {
  std::vector<std::string> names;
  for (const Recording& recording : recordings) names.push_back(recording.name);
  return names;
}

using Strings = std::vector<std::string>;

TEST(DiagnosisRecordings, HoldsOutWholeRuns) {
  const DiagnosisRecordings chosen = ChooseRecordings(Runs({0, 0, 1, 2, 2, 3}), {});
  EXPECT_EQ(Names(chosen.fit), (Strings{"0", "0", "1", "3"}));
  EXPECT_EQ(Names(chosen.held_out), (Strings{"2", "2"}));
}

TEST(DiagnosisRecordings, HoldsOutNoneOfFewRuns) {
  const DiagnosisRecordings chosen = ChooseRecordings(Runs({0, 1, 1, 2}), {});
  EXPECT_EQ(Names(chosen.fit), (Strings{"0", "1", "1", "2"}));
  EXPECT_TRUE(chosen.held_out.empty());
}

TEST(DiagnosisRecordings, JudgesByWhatIsGiven) {
  const FitData given = Runs({8, 9});
  const DiagnosisRecordings chosen = ChooseRecordings(Runs({0, 1, 2, 3}), given.recordings);
  EXPECT_EQ(Names(chosen.fit), (Strings{"0", "1", "2", "3"}));
  EXPECT_EQ(Names(chosen.held_out), (Strings{"8", "9"}));
}

TEST(DiagnosisRecordings, TakesAFewOfMany) {
  std::vector<int> runs;
  for (int run = 0; run < 16; ++run) runs.insert(runs.end(), 3, run);
  const DiagnosisRecordings chosen = ChooseRecordings(Runs(runs), {});
  EXPECT_EQ(Names(chosen.fit), (Strings{"1", "5", "9", "13"}));
  EXPECT_EQ(Names(chosen.held_out), (Strings{"2", "6", "10", "14"}));
}

TEST(DiagnosisRecordings, TakesFewerLongOnes) {
  FitData data = Runs({0, 1, 2, 3, 4, 5, 6, 7});
  for (Recording& recording : data.recordings) recording.points.resize(499);
  const DiagnosisRecordings chosen = ChooseRecordings(data, {});
  EXPECT_EQ(Names(chosen.fit), (Strings{"1", "5"}));
  EXPECT_EQ(Names(chosen.held_out), (Strings{"2", "6"}));
  for (Recording& recording : data.recordings) recording.points.resize(5000);
  EXPECT_EQ(ChooseRecordings(data, {}).fit.size(), 1);
}

}  // namespace
}  // namespace physpring
