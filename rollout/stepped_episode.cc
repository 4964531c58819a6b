// SPDX-License-Identifier: Apache-2.0
#include "rollout/stepped_episode.h"

#include <fmt/format.h>

#include "rollout/stopwatch.h"

namespace physpring {

void ExpectAction(const Eigen::VectorXd& action, const RobotOptions& robot) {
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

void SteppedEpisode::Begin() {
  {
    const Stopwatch watch(&result_.seconds.physics);
    simulation_.Reset(result_.episode.start);
  }
  Observe(0);
}

void SteppedEpisode::Step(const Eigen::VectorXd& action) {
  const RobotOptions& robot = model_.task->robot;
  ExpectAction(action, robot);
  Eigen::VectorXd moved = action;
  if (robot.kind == RobotKind::kCartesian) {
    moved.head<3>() += result_.episode.start.action_offset;
  }
  result_.episode.actions.push_back(moved);
  {
    const Stopwatch watch(&result_.seconds.physics);
    simulation_.RunFrame(moved);
  }
  const int frame = observation_.frame;
  Observe(frame + 1);
  const Stopwatch watch(&result_.seconds.scoring);
  verdict_ = simulation_.Judge(observation_.particles);
  result_.episode.value.push_back(verdict_.value);
  counts_ = frame >= model_.task->success.from_frame;
  result_.episode.met_frames += verdict_.met && counts_ ? 1 : 0;
}

void SteppedEpisode::Observe(int frame) {
  const Stopwatch watch(&result_.seconds.scoring);
  observation_.frame = frame;
  observation_.robot = simulation_.Robot();
  observation_.hand = simulation_.Hand();
  observation_.joints = simulation_.Joints();
  observation_.gripper = simulation_.Gripper();
  observation_.sensors = simulation_.Sensors();
  observation_.particles = simulation_.Particles();
  result_.episode.robot.push_back(observation_.robot);
  result_.episode.nodes.push_back(simulation_.Nodes());
}

}  // namespace physpring
