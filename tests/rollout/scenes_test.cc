// SPDX-License-Identifier: Apache-2.0
// The tasks in models/scenes/: their scripted policies do what they are for, at the coarsest level
// and with a policy that misses, not.
#include <gtest/gtest.h>

#include "rollout/plugin_library.h"
#include "rollout/sweep.h"

namespace physpring {
namespace {

// The first start, at the coarsest level.
EpisodeSummary Run(const std::string& name, double action_noise) {
  LoadPluginLibrary(PHYSPRING_PLUGIN);
  const Task task = ReadTask(std::string(PHYSPRING_MODELS) + "/scenes/" + name);
  SweepOptions options;
  options.levels = {static_cast<int>(task.levels.size()) - 1};
  options.policy.text = "scripted";
  options.disturbance.action_noise = action_noise;
  return RunSweep(task, options, {}).episodes.at(0);
}

class Scenes : public testing::TestWithParam<std::string> {};

TEST_P(Scenes, ScriptSucceeds) {
  const EpisodeSummary episode = Run(GetParam(), 0);
  EXPECT_EQ(episode.problem, "");
  EXPECT_TRUE(episode.success) << episode.value;
}

TEST_P(Scenes, ScriptThatMissesByFarFails) {
  const EpisodeSummary episode = Run(GetParam(), 1);
  EXPECT_FALSE(episode.success) << episode.value;
}

INSTANTIATE_TEST_SUITE_P(Tasks, Scenes, testing::Values("rope_routing", "toy_packing"),
                         [](const auto& task) { return task.param; });

}  // namespace
}  // namespace physpring
