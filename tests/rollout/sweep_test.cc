// SPDX-License-Identifier: Apache-2.0
#include "rollout/sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>

#include "rollout/plugin_library.h"
#include "rollout/sweep_folder.h"
#include "tests/support/file_damage.h"
#include "tests/support/small_task.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/npz.h"

namespace physpring {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A policy of the test's own.
class FixedPolicy : public Policy {
 public:
  explicit FixedPolicy(Eigen::VectorXd action) : action_(std::move(action)) {}
  void Reset(std::uint64_t) override {}
  Eigen::VectorXd Act(const Observation&) override { return action_; }

 private:
  Eigen::VectorXd action_;
};

class SweepTest : public testing::Test {
 protected:
  void SetUp() override { LoadPluginLibrary(PHYSPRING_PLUGIN); }

  SweepOptions Options(const std::string& policy) const {
    SweepOptions options;
    options.policy.text = policy;
    options.episodes = 4;
    return options;
  }

  Sweep Run(const SweepOptions& options) const {
    return RunSweep(ReadTask(task_.path()), options, {});
  }

  std::string Folder(const std::string& name) const { return folder_.File(name); }

  // All files of a sweep but the timing, by name.
  std::map<std::string, std::string> Bytes(const std::string& name) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(Folder(name))) {
      const std::string path = entry.path().string();
      if (entry.is_regular_file() && !path.ends_with(".seconds.json")) {
        files[path.substr(Folder(name).size())] = ReadFile(path);
      }
    }
    return files;
  }

  EpisodeResult RunOne(Policy* policy) const {
    const Task task = ReadTask(task_.path());
    std::vector<std::string> warnings;
    const TaskModel model = MakeTaskModel(task, 0, &warnings);
    Simulation simulation(model);
    return RunEpisode(model, StartOf(task, 0, 0, {}), &simulation, policy, nullptr);
  }

  SmallTask task_;
  TemporaryFolder folder_;
};

TEST_F(SweepTest, PushingSucceedsAtEveryLevelAndWaitingAtNone) {
  SweepOptions options = Options("replay:" + task_.WriteActions(0.1, 15));
  options.levels = {0, 1, 2};
  for (const EpisodeSummary& episode : Run(options).episodes) {
    EXPECT_TRUE(episode.success) << "level " << episode.level << " episode " << episode.episode
                                 << " value " << episode.value << episode.problem;
  }
  options.policy.text = "replay:" + task_.WriteActions(0, 15);
  for (const EpisodeSummary& episode : Run(options).episodes) EXPECT_FALSE(episode.success);
}

TEST_F(SweepTest, SameSeedGivesTheSameBytesForAnyNumberOfThreads) {
  SweepOptions options = Options("random");
  options.levels = {0, 2};
  options.disturbance.action = 0.005;
  options.folder = Folder("one");
  Run(options);
  options.folder = Folder("three");
  options.threads = 3;
  Run(options);
  ASSERT_EQ(Bytes("one").size(), 1 + 2 * (1 + 8));  // verdict and states of 4 episodes each
  EXPECT_EQ(Bytes("one"), Bytes("three"));
}

TEST_F(SweepTest, ReplayOfEpisodesGivesTheSameBytes) {
  SweepOptions options = Options("random");
  options.folder = Folder("first");
  Run(options);
  options.policy.text = "replay:" + Folder("first");
  options.folder = Folder("again");
  Run(options);
  auto first = Bytes("first"), again = Bytes("again");
  first.erase("/sweep.json");  // names the policy
  again.erase("/sweep.json");
  EXPECT_EQ(first, again);
}

// Each is put right by the next run, which says so, and no other episode is run again.
TEST_F(SweepTest, RunsDamagedEpisodesAgain) {
  SweepOptions options = Options("random");
  options.folder = Folder("sweep");
  Run(options);
  const auto whole = Bytes("sweep");
  const std::string states = EpisodePath(options.folder, 0, 2) + ".npz";
  const std::string verdict = EpisodePath(options.folder, 0, 2) + ".json";
  std::string flipped = ReadFile(states);
  flipped[flipped.size() / 2] ^= 1;
  const std::string other = ReadFile(EpisodePath(options.folder, 0, 1) + ".npz");
  const std::map<std::string, std::function<void()>> damages = {
      {states + ": cannot be read: No such file", [&] { fs::remove(states); }},
      {states + ": is damaged", [&] { WriteFileAtomically(states, flipped); }},
      {states + ": is damaged: its hash", [&] { WriteFileAtomically(states, other); }},
      {verdict + ": ", [&] { WriteFileAtomically(verdict, "{\"episode\": 2,"); }},
  };
  for (const auto& [warning, damage] : damages) {
    damage();
    EXPECT_THAT(
        ErrorOf(warning.substr(0, warning.find(':')), [&] { ReadSweepFolder(options.folder); }),
        HasSubstr(warning));  // so it cannot be merged
    const Sweep again = Run(options);
    EXPECT_EQ(again.skipped, 3);
    ASSERT_EQ(again.warnings.size(), 1u);
    EXPECT_THAT(again.warnings[0], HasSubstr(warning));
    EXPECT_THAT(again.warnings[0], HasSubstr("the episode is run again"));
    EXPECT_EQ(Bytes("sweep"), whole);
  }
}

TEST_F(SweepTest, MissesNoTimes) {
  SweepOptions options = Options("random");
  options.folder = Folder("sweep");
  Run(options);
  fs::remove(EpisodePath(options.folder, 0, 1) + ".seconds.json");
  WriteFileAtomically(EpisodePath(options.folder, 0, 2) + ".seconds.json", "");
  const Sweep again = Run(options);
  EXPECT_EQ(again.skipped, 4);
  EXPECT_FALSE(again.episodes[1].seconds);
  EXPECT_FALSE(again.episodes[2].seconds);
  EXPECT_TRUE(again.episodes[3].seconds);
  EXPECT_EQ(ReadSweepFolder(options.folder).episodes.size(), 4u);
}

// Of a version that did not know the hash.
TEST_F(SweepTest, ReadsVerdictsWithoutAHash) {
  SweepOptions options = Options("random");
  options.folder = Folder("sweep");
  Run(options);
  const std::string path = EpisodePath(options.folder, 0, 0);
  std::string verdict = ReadFile(path + ".json");
  const std::size_t hash = verdict.find(",\n \"npz_hash\"");
  ASSERT_NE(hash, std::string::npos);
  WriteFileAtomically(path + ".json", verdict.substr(0, hash) + "\n}\n");
  EXPECT_EQ(Run(options).skipped, 4);
  fs::resize_file(path + ".npz", 100);
  EXPECT_EQ(Run(options).skipped, 3);
}

TEST_F(SweepTest, NeedsToKnowWhatTheEpisodesAreOf) {
  SweepOptions options = Options("random");
  options.folder = Folder("sweep");
  Run(options);
  fs::remove(options.folder + "/sweep.json");
  EXPECT_THAT(ErrorOf(options.folder + "/sweep.json", [&] { Run(options); }),
              HasSubstr("is missing"));
}

TEST_F(SweepTest, RemovesWhatAKilledOneLeft) {
  SweepOptions options = Options("random");
  options.folder = Folder("sweep");
  Run(options);
  const auto whole = Bytes("sweep");
  WriteFileAtomically(EpisodePath(options.folder, 0, 1) + ".npz.1-2.tmp", "half");
  Run(options);
  EXPECT_EQ(Bytes("sweep"), whole);
}

TEST_F(SweepTest, AnotherSeedStartsElsewhere) {
  const Task task = ReadTask(task_.path());
  const EpisodeStart one = StartOf(task, 1, 0, {}), two = StartOf(task, 2, 0, {});
  EXPECT_GT((one.object.position - two.object.position).norm(), 1e-5);
  EXPECT_NE(one.seed, two.seed);
}

TEST_F(SweepTest, PerturbedStartDiffersByThatAlone) {
  const Task task = ReadTask(task_.path());
  const EpisodeStart plain = StartOf(task, 1, 3, {}), moved = StartOf(task, 1, 3, {0, 1e-6});
  EXPECT_NEAR((plain.object.position - moved.object.position).norm(), 1e-6, 1e-15);
  EXPECT_EQ(plain.seed, moved.seed);
}

TEST_F(SweepTest, StartsWalkThroughTheGrid) {
  const Task task = ReadTask(task_.path());
  std::vector<double> x, yaw;
  for (int episode = 0; episode < 4; ++episode) {
    const Pose object = StartOf(task, 0, episode, {}).object;
    x.push_back(object.position.x());
    yaw.push_back(2 * std::atan2(object.orientation.z(), object.orientation.w()));
  }
  using testing::DoubleNear;
  const double degree = std::acos(-1.0) / 180;
  EXPECT_THAT(x, testing::ElementsAre(DoubleNear(-0.01, 0.002), DoubleNear(-0.01, 0.002),
                                      DoubleNear(0.01, 0.002), DoubleNear(0.01, 0.002)));
  EXPECT_THAT(
      yaw, testing::ElementsAre(DoubleNear(-5 * degree, degree), DoubleNear(5 * degree, degree),
                                DoubleNear(-5 * degree, degree), DoubleNear(5 * degree, degree)));
}

TEST_F(SweepTest, FinishedEpisodesAreNotRunAgain) {
  SweepOptions options = Options("random");
  options.folder = Folder("kept");
  options.episodes = 2;
  Run(options);
  options.episodes = 3;
  const Sweep sweep = Run(options);
  EXPECT_EQ(sweep.skipped, 2);
  EXPECT_EQ(sweep.episodes.size(), 3u);
}

TEST_F(SweepTest, ShardsTogetherAreTheWhole) {
  SweepOptions options = Options("random");
  options.folder = Folder("whole");
  Run(options);
  options.folder = Folder("shards");
  options.shards = 3;
  std::size_t episodes = 0;
  for (options.shard = 1; options.shard <= 3; ++options.shard) {
    episodes += Run(options).episodes.size();
  }
  EXPECT_EQ(episodes, 4u);
  EXPECT_EQ(Bytes("whole"), Bytes("shards"));
}

TEST_F(SweepTest, FolderOfAnotherSweepIsRefused) {
  SweepOptions options = Options("random");
  options.episodes = 1;
  options.folder = Folder("kept");
  Run(options);
  options.seed = 5;
  try {
    Run(options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("seed 0, not 5"));
  }
}

TEST_F(SweepTest, WrongActionsEndTheEpisodeWithAReason) {
  FixedPolicy short_one(Eigen::VectorXd::Zero(3));
  EXPECT_THAT(RunOne(&short_one).episode.problem, HasSubstr("has 3 numbers, expected 8"));
  Eigen::VectorXd action = CartesianAction({}, 0);
  action[1] = NAN;
  FixedPolicy lying(action);
  const EpisodeResult result = RunOne(&lying);
  EXPECT_THAT(result.episode.problem, HasSubstr("not finite"));
  EXPECT_FALSE(result.episode.success);
}

TEST_F(SweepTest, HandGoesNoFasterThanTheTaskAllows) {
  FixedPolicy far(CartesianAction({{0.04, -5, 0.03}, Yaw(0)}, 0));
  const TaskEpisode episode = RunOne(&far).episode;
  ASSERT_EQ(episode.problem, "");
  // 20 frames at 0.5 m/s and 30 Hz: the hand hangs behind its target by what the weld gives
  EXPECT_NEAR(episode.robot.back()[1], -0.06 - 20 * 0.5 / 30, 0.03);
}

TEST_F(SweepTest, StatesAreThoseOfTheNodes) {
  SweepOptions options = Options("random");
  options.episodes = 1;
  options.levels = {1};
  options.folder = Folder("kept");
  Run(options);
  const Npz arrays = ReadNpz(EpisodePath(options.folder, 1, 0) + ".npz");
  EXPECT_THAT(arrays.at("nodes").shape, testing::ElementsAre(21u, 20u, 3u));
  EXPECT_THAT(arrays.at("robot").shape, testing::ElementsAre(21u, 8u));
  EXPECT_THAT(arrays.at("actions").shape, testing::ElementsAre(20u, 8u));
}

}  // namespace
}  // namespace physpring
