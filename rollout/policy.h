// SPDX-License-Identifier: Apache-2.0
// What drives the robot: asked for an action in each frame of an episode.
#ifndef PHYSPRING_ROLLOUT_POLICY_H_
#define PHYSPRING_ROLLOUT_POLICY_H_

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pictures/image.h"
#include "rollout/task.h"
#include "twin/points.h"

namespace physpring {

struct Observation {
  int frame = 0;
  // Cartesian: the hand's x y z qw qx qy qz [m] and the gripper as commanded, 0 open to 1 closed.
  // Joints: the actuated joints' positions.
  Eigen::VectorXd robot;
  Pose hand;               // of the robot's hand, where the task names one
  Eigen::VectorXd joints;  // as measured: the driven joints but the gripper's (joints)
  double gripper = 0;      // as measured, 0 open to 1 closed
  std::map<std::string, Eigen::VectorXd> sensors;  // of the last step, by the task's names
  Points particles;                                // 3 x level-0 particles in the world, m, lifted
  std::map<std::string, Image> images;             // by camera; only for policies that need them
};

// One policy drives one episode at a time, in one thread.
class Policy {
 public:
  virtual ~Policy() = default;

  // Whether Act wants images.
  virtual bool NeedsImages() const { return false; }

  // An episode begins. `seed`: of this episode, the same for every level of the twin.
  virtual void Reset(std::uint64_t seed) = 0;

  // The action for the frame that begins with `observation`: RobotOptions::action_size() numbers,
  // absolute. Throws PolicyError where there is none.
  virtual Eigen::VectorXd Act(const Observation& observation) = 0;
};

// The policy failed, not the simulation: the episode ends without success and its record says why.
class PolicyError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// What serves the policy failed: no verdict on the policy. The episode is not kept.
class PolicyServerError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// How long a policy server may take, s.
struct ServerPatience {
  double wait = 60;           // until it can be connected to
  double first_answer = 600;  // of a connection: a model may be compiled
  double answer = 60;
};

// The 8 numbers of a Cartesian action. `gripper`: 0 open to 1 closed.
Eigen::VectorXd CartesianAction(const Pose& hand, double gripper);

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_POLICY_H_
