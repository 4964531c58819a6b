// SPDX-License-Identifier: Apache-2.0
// A task in motion, frame by frame: one thread's.
#ifndef PHYSPRING_ROLLOUT_SIMULATION_H_
#define PHYSPRING_ROLLOUT_SIMULATION_H_

#include <optional>

#include "rollout/policy.h"
#include "rollout/start.h"
#include "rollout/task_model.h"
#include "twin/lift.h"

namespace physpring {

class Simulation {
 public:
  explicit Simulation(const TaskModel& task_model);  // lives longer

  // Puts the object and the robot where the episode starts, and lets the scene settle.
  void Reset(const EpisodeStart& start);

  // Simulates one frame. Cartesian actions are followed no faster than the robot's speeds allow;
  // the target moves evenly through the frame. Throws Error when the simulation is unstable.
  void RunFrame(const Eigen::VectorXd& action);

  // The present state.
  Points Nodes() const;           // 3 x nodes of the level, m
  Points Particles() const;       // 3 x level-0 particles, m, lifted
  Eigen::VectorXd Robot() const;  // see Observation, as what follows
  Pose Hand() const;
  Eigen::VectorXd Joints() const;
  double Gripper() const;
  std::map<std::string, Eigen::VectorXd> Sensors() const;
  SuccessRule::Verdict Judge(const Points& particles) const;
  const mjData& data() const { return *data_; }

 private:
  // Where a Cartesian action is; the command of joints is kept as it is.
  struct Command {
    Pose target;
    double gripper = 0;
  };
  Command Limit(const Command& wish) const;
  void Place(const Command& command);

  const TaskModel& model_;
  DataPtr data_;
  std::optional<Lift> lift_;
  Command command_;
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_SIMULATION_H_
