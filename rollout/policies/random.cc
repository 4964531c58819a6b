// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/random.h"

#include <cmath>
#include <random>

#include "twin/uniform.h"

namespace physpring {
namespace {

constexpr double kReach = 0.15;      // m
constexpr double kJointReach = 0.3;  // rad or m
constexpr double kHold = 0.5;        // s, between two goals

class RandomPolicy : public Policy {
 public:
  explicit RandomPolicy(const Task& task)
      : kind_(task.robot.kind), hold_(std::max(1, static_cast<int>(kHold * task.rate))) {}

  void Reset(std::uint64_t seed) override { random_.seed(seed); }

  Eigen::VectorXd Act(const Observation& observation) override {
    if (observation.frame == 0) home_ = observation.robot;
    if (observation.frame % hold_ == 0) ChooseGoal();
    return goal_;
  }

 private:
  double Either() { return 2 * Uniform(&random_) - 1; }  // in [-1, 1)

  void ChooseGoal() {
    goal_ = home_;
    if (kind_ == RobotKind::kJoints) {
      for (double& joint : goal_) joint += kJointReach * Either();
      return;
    }
    for (double& coordinate : goal_.head<3>()) coordinate += kReach * Either();
    goal_[7] = (Either() + 1) / 2;
  }

  RobotKind kind_;
  int hold_;  // frames
  std::mt19937_64 random_;
  Eigen::VectorXd home_, goal_;
};

}  // namespace

std::unique_ptr<Policy> MakeRandomPolicy(const Task& task) {
  return std::make_unique<RandomPolicy>(task);
}

}  // namespace physpring
