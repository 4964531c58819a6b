// SPDX-License-Identifier: Apache-2.0
#include "rollout/episode.h"

#include "rollout/stepped_episode.h"
#include "rollout/stopwatch.h"
#include "twin/error.h"

namespace physpring {
namespace {

// One episode under way.
struct Run {
  const TaskModel& model;
  Simulation& simulation;
  Policy& policy;
  Viewer* viewer;
  const std::function<bool()>& stop;
  EpisodeResult result;

  Observation Look(Observation observation) {
    if (!viewer) return observation;
    viewer->Show(simulation.data());
    if (policy.NeedsImages()) observation.images = viewer->Look(simulation.data());
    return observation;
  }

  Eigen::VectorXd Act(const Observation& observation) {
    const Stopwatch watch(&result.seconds.policy);
    return policy.Act(observation);
  }

  void AllFrames() {
    policy.Reset(result.episode.start.seed);
    SteppedEpisode episode(model, &simulation, &result);
    episode.Begin();
    while (!episode.over()) {
      result.stopped = stop && stop();
      if (result.stopped) return;
      episode.Step(Act(Look(episode.observation())));
    }
    result.episode.success = episode.success();
  }
};

}  // namespace

EpisodeResult RunEpisode(const TaskModel& model, const EpisodeStart& start, Simulation* simulation,
                         Policy* policy, Viewer* viewer, const std::function<bool()>& stop) {
  Run run{model, *simulation, *policy, viewer, stop, {}};
  run.result.episode.start = start;
  run.result.episode.level = model.level;
  const double drawn = viewer ? viewer->seconds() : 0;
  {
    const Stopwatch watch(&run.result.seconds.total);
    try {
      run.AllFrames();
    } catch (const PolicyError& error) {
      run.result.episode.problem = error.what();
    } catch (const Error& error) {
      run.result.episode.problem = error.what();
    }
    if (viewer && !run.result.stopped) viewer->Finish();
  }
  if (viewer) run.result.seconds.rendering = viewer->seconds() - drawn;
  return std::move(run.result);
}

}  // namespace physpring
