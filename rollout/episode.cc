// SPDX-License-Identifier: Apache-2.0
#include "rollout/episode.h"

#include <fmt/format.h>

#include <chrono>

#include "twin/error.h"

namespace physpring {
namespace {

using Clock = std::chrono::steady_clock;

// Adds the time of its life to `sum`.
class Stopwatch {
 public:
  explicit Stopwatch(double* sum) : sum_(sum) {}
  ~Stopwatch() { *sum_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double* sum_;
  Clock::time_point start_ = Clock::now();
};

// Throws PolicyError unless the simulation can follow it.
void CheckAction(const Eigen::VectorXd& action, const RobotOptions& robot) {
  if (action.size() != robot.action_size()) {
    throw PolicyError(fmt::format("the policy's action has {} numbers, expected {}", action.size(),
                                  robot.action_size()));
  }
  if (!action.allFinite()) throw PolicyError("the policy's action has numbers that are not finite");
  if (robot.kind != RobotKind::kCartesian) return;
  constexpr double kLeastNorm = 1e-3, kMostNorm = 1e3;
  const double norm = action.segment<4>(3).norm();
  if (norm >= kLeastNorm && norm <= kMostNorm) return;
  throw PolicyError(fmt::format("the policy's action has a quaternion of length {:.3g}", norm));
}

// One episode under way.
struct Run {
  const TaskModel& model;
  Simulation& simulation;
  Policy& policy;
  Viewer* viewer;
  const std::function<bool()>& stop;
  EpisodeResult result;
  Observation observation;

  void Observe(int frame) {
    TaskEpisode& episode = result.episode;
    const Stopwatch watch(&result.seconds.scoring);
    observation.frame = frame;
    observation.robot = simulation.Robot();
    observation.particles = simulation.Particles();
    episode.robot.push_back(observation.robot);
    episode.nodes.push_back(simulation.Nodes());
  }

  void Look() {
    observation.images.clear();
    if (!viewer) return;
    viewer->Show(simulation.data());
    if (policy.NeedsImages()) observation.images = viewer->Look(simulation.data());
  }

  Eigen::VectorXd Act() {
    const Stopwatch watch(&result.seconds.policy);
    Eigen::VectorXd action = policy.Act(observation);
    const RobotOptions& robot = model.task->robot;
    CheckAction(action, robot);
    if (robot.kind == RobotKind::kCartesian) {
      action.head<3>() += result.episode.start.action_offset;
    }
    return action;
  }

  void Frame(int frame) {
    Look();
    const Eigen::VectorXd action = Act();
    result.episode.actions.push_back(action);
    {
      const Stopwatch watch(&result.seconds.physics);
      simulation.RunFrame(action);
    }
    Observe(frame + 1);
    const Stopwatch watch(&result.seconds.scoring);
    const SuccessRule::Verdict verdict = simulation.Judge(observation.particles);
    result.episode.value.push_back(verdict.value);
    const bool counts = frame >= model.task->success.from_frame;
    result.episode.met_frames += verdict.met && counts ? 1 : 0;
  }

  void AllFrames() {
    const EpisodeStart& start = result.episode.start;
    policy.Reset(start.seed);
    {
      const Stopwatch watch(&result.seconds.physics);
      simulation.Reset(start);
    }
    Observe(0);
    for (int frame = 0; frame < model.task->frames; ++frame) {
      result.stopped = stop && stop();
      if (result.stopped) return;
      Frame(frame);
    }
    result.episode.success = result.episode.met_frames >= model.task->success.at_least;
  }
};

}  // namespace

EpisodeResult RunEpisode(const TaskModel& model, const EpisodeStart& start, Simulation* simulation,
                         Policy* policy, Viewer* viewer, const std::function<bool()>& stop) {
  Run run{model, *simulation, *policy, viewer, stop, {}, {}};
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
