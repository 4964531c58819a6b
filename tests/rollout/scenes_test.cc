// SPDX-License-Identifier: Apache-2.0
// The tasks in models/scenes/: their scripted policies do what they are for, at the coarsest level
// and do not where they miss by far.
#include <gtest/gtest.h>

#include "rollout/plugin_library.h"
#include "rollout/sweep.h"

namespace physpring {
namespace {

// The second start, at the coarsest level.
EpisodeSummary RunSecond(const std::string& name, double action_noise) {
  LoadPluginLibrary(PHYSPRING_PLUGIN);
  const Task task = ReadTask(std::string(PHYSPRING_MODELS) + "/scenes/" + name);
  SweepOptions options;
  options.levels = {static_cast<int>(task.levels.size()) - 1};
  options.first = 1;
  options.policy.text = "scripted";
  options.disturbance.action = action_noise;
  return RunSweep(task, options, {}).episodes.at(0);
}

class Scenes : public testing::TestWithParam<std::string> {};

TEST_P(Scenes, ScriptSucceeds) {
  const EpisodeSummary episode = RunSecond(GetParam(), 0);
  EXPECT_EQ(episode.problem, "");
  EXPECT_TRUE(episode.success) << episode.value;
}

TEST_P(Scenes, ScriptThatMissesByFarFails) {
  const EpisodeSummary episode = RunSecond(GetParam(), 1);
  EXPECT_FALSE(episode.success) << episode.value;
}

INSTANTIATE_TEST_SUITE_P(Tasks, Scenes,
                         testing::Values("cloth_folding", "rope_routing", "t_push", "toy_packing"),
                         [](const auto& task) { return task.param; });

}  // namespace
}  // namespace physpring
