// SPDX-License-Identifier: Apache-2.0
#include "rollout/simulation.h"

#include <algorithm>
#include <cmath>

namespace physpring {
namespace {

Pose MocapPose(const mjData& data, int mocap) {
  const double* q = data.mocap_quat + 4 * mocap;
  return {Eigen::Map<const Eigen::Vector3d>(data.mocap_pos + 3 * mocap),
          UnitQuaternion(q[0], q[1], q[2], q[3])};
}

// The point `x` turned by an orientation.
Eigen::Vector3d Turn(const Eigen::Quaterniond& orientation, const Eigen::Vector3d& x) {
  const double quaternion[] = {orientation.w(), orientation.x(), orientation.y(), orientation.z()};
  Eigen::Vector3d turned;
  mju_rotVecQuat(turned.data(), x.data(), quaternion);
  return turned;
}

Pose Between(const Pose& from, const Pose& to, double share) {
  return {from.position + share * (to.position - from.position),
          Slerp(from.orientation, to.orientation, share)};
}

}  // namespace

Simulation::Simulation(const TaskModel& task_model)
    : model_(task_model), data_(MakeData(*task_model.model)) {}

void Simulation::Reset(const EpisodeStart& start) {
  const Task& task = *model_.task;
  const mjModel& model = *model_.model;
  mj_resetData(&model, data_.get());

  // each node to its place at the start, by its slide joints
  const Pose& object = start.object;
  const Eigen::Quaterniond back = model_.parent.orientation.conjugate();
  for (int i = 0; i < model_.node_count(); ++i) {
    const Eigen::Vector3d reference = model_.reference.col(i);
    const Eigen::Vector3d place = Turn(object.orientation, reference) + object.position;
    const Eigen::Vector3d local = Turn(back, place - model_.parent.position);
    Eigen::Map<Eigen::Vector3d>(data_->qpos + model_.node_qpos[i]) = local - reference;
  }
  const SpringMassSystem& dense = task.twin.levels[0].system;
  lift_.emplace(task.twin, model_.level,
                object.ToWorld(dense.position.leftCols(dense.node_count())));

  Eigen::VectorXd home = task.robot.home;
  if (task.robot.kind == RobotKind::kCartesian) {
    command_ = {MocapPose(*data_, model_.target), 0};
    Place(command_);
    if (home.size() == 0) home = CartesianAction(command_.target, 0);
  } else if (home.size() == 0) {
    home = Robot();
  }
  for (int frame = 0; frame < task.settle; ++frame) RunFrame(home);
  mj_kinematics(&model, data_.get());
}

Simulation::Command Simulation::Limit(const Command& wish) const {
  const RobotOptions& robot = model_.task->robot;
  const double frame = 1 / model_.task->rate;  // s
  const auto share = [&](double way, double speed) {
    return way > speed * frame ? speed * frame / way : 1.0;
  };
  Command command;
  const Eigen::Vector3d way = wish.target.position - command_.target.position;
  command.target.position =
      command_.target.position + share(mju_norm3(way.data()), robot.speed) * way;
  const double turn = AngleBetween(command_.target.orientation, wish.target.orientation);
  command.target.orientation =
      Slerp(command_.target.orientation, wish.target.orientation, share(turn, robot.turn_speed));
  const double grip = std::clamp(wish.gripper, 0.0, 1.0) - command_.gripper;
  command.gripper = command_.gripper + share(std::abs(grip), robot.gripper_speed) * grip;
  return command;
}

void Simulation::Place(const Command& command) {
  const RobotOptions& robot = model_.task->robot;
  const Eigen::Quaterniond& q = command.target.orientation;
  const double quaternion[] = {q.w(), q.x(), q.y(), q.z()};
  mju_copy3(data_->mocap_pos + 3 * model_.target, command.target.position.data());
  mju_copy4(data_->mocap_quat + 4 * model_.target, quaternion);
  for (std::size_t i = 0; i < model_.actuators.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    data_->ctrl[model_.actuators[i]] =
        robot.open[k] + command.gripper * (robot.closed[k] - robot.open[k]);
  }
}

void Simulation::RunFrame(const Eigen::VectorXd& action) {
  const mjModel& model = *model_.model;
  if (model_.task->robot.kind == RobotKind::kJoints) {
    for (std::size_t i = 0; i < model_.actuators.size(); ++i) {
      data_->ctrl[model_.actuators[i]] = action[static_cast<Eigen::Index>(i)];
    }
    for (int step = 0; step < model_.steps; ++step) Step(model, data_.get());
  } else {
    const Command from = command_;
    const Pose wish{action.head<3>(), UnitQuaternion(action[3], action[4], action[5], action[6])};
    const Command to = Limit({wish, action[7]});
    for (int step = 1; step <= model_.steps; ++step) {
      const double share = static_cast<double>(step) / model_.steps;
      Place({Between(from.target, to.target, share),
             from.gripper + share * (to.gripper - from.gripper)});
      Step(model, data_.get());
    }
    command_ = to;
  }
  mj_kinematics(&model, data_.get());
}

Points Simulation::Nodes() const { return model_.NodesIn(*data_); }

Points Simulation::Particles() const { return lift_->Apply(Nodes()); }

Eigen::VectorXd Simulation::Robot() const {
  if (model_.task->robot.kind == RobotKind::kJoints) {
    Eigen::VectorXd joints(static_cast<Eigen::Index>(model_.joint_qpos.size()));
    for (Eigen::Index i = 0; i < joints.size(); ++i) {
      joints[i] = data_->qpos[model_.joint_qpos[static_cast<std::size_t>(i)]];
    }
    return joints;
  }
  return CartesianAction(Hand(), command_.gripper);
}

Pose Simulation::Hand() const {
  if (model_.hand < 0) return {};
  double q[4];
  mju_mat2Quat(q, data_->site_xmat + 9 * model_.hand);
  return {Eigen::Map<const Eigen::Vector3d>(data_->site_xpos + 3 * model_.hand),
          Eigen::Quaterniond(q[0], q[1], q[2], q[3])};
}

Eigen::VectorXd Simulation::Joints() const {
  if (model_.task->robot.kind != RobotKind::kJoints) return {};
  const Eigen::VectorXd all = Robot();
  return all.head(all.size() - model_.task->robot.fingers);
}

double Simulation::Gripper() const {
  const RobotOptions& robot = model_.task->robot;
  if (robot.fingers == 0) return 0;
  double closed = 0;
  for (int i = 0; i < robot.fingers; ++i) {
    const std::size_t actuator = model_.actuators.size() - robot.fingers + i;
    const int place = model_.joint_qpos[actuator];
    const double at = place >= 0 ? data_->qpos[place] : data_->ctrl[model_.actuators[actuator]];
    closed += (at - robot.open[i]) / (robot.closed[i] - robot.open[i]) / robot.fingers;
  }
  return std::clamp(closed, 0.0, 1.0);
}

std::map<std::string, Eigen::VectorXd> Simulation::Sensors() const {
  const mjModel& model = *model_.model;
  std::map<std::string, Eigen::VectorXd> sensors;
  for (std::size_t i = 0; i < model_.sensors.size(); ++i) {
    const int sensor = model_.sensors[i];
    sensors[model_.task->sensors[i]] = Eigen::Map<const Eigen::VectorXd>(
        data_->sensordata + model.sensor_adr[sensor], model.sensor_dim[sensor]);
  }
  return sensors;
}

SuccessRule::Verdict Simulation::Judge(const Points& particles) const {
  if (model_.success_body == 0) return model_.success->Judge(particles);
  const double* q = data_->xquat + 4 * model_.success_body;
  const Pose body{Eigen::Map<const Eigen::Vector3d>(data_->xpos + 3 * model_.success_body),
                  Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized()};
  return model_.success->Judge(body.ToLocal(particles));
}

}  // namespace physpring
