// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/replay.h"

#include <fmt/format.h>

#include <algorithm>

#include "twin/error.h"
#include "twin/npz.h"

namespace physpring {
namespace {

class ReplayPolicy : public Policy {
 public:
  explicit ReplayPolicy(Eigen::MatrixXd actions) : actions_(std::move(actions)) {}

  void Reset(std::uint64_t) override {}

  Eigen::VectorXd Act(const Observation& observation) override {
    return actions_.col(std::min<Eigen::Index>(observation.frame, actions_.cols() - 1));
  }

 private:
  Eigen::MatrixXd actions_;  // numbers x frames
};

}  // namespace

std::unique_ptr<Policy> MakeReplayPolicy(const Task& task, const std::string& file) {
  const Npz arrays = ReadNpz(file);
  const auto found = arrays.find("actions");
  const auto size = static_cast<std::size_t>(task.robot.action_size());
  if (found == arrays.end()) throw Error(file + ": has no array 'actions'");
  const NpzArray& array = found->second;
  if (array.shape.size() != 2 || array.shape[0] == 0 || array.shape[1] != size) {
    throw Error(fmt::format("{}: array 'actions' must be (frames, {})", file, size));
  }
  const std::vector<double> values = array.ToDoubles();
  return std::make_unique<ReplayPolicy>(Eigen::Map<const Eigen::MatrixXd>(
      values.data(), static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(array.shape[0])));
}

}  // namespace physpring
