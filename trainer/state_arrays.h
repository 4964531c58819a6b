// SPDX-License-Identifier: Apache-2.0
// A fit's state as the arrays "train/NAME" of a twin file, and back.
#ifndef PHYSPRING_TRAINER_STATE_ARRAYS_H_
#define PHYSPRING_TRAINER_STATE_ARRAYS_H_

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "twin/npz.h"

namespace physpring {

using StateArrays = std::map<std::string, NpzArray>;

NpzArray StoreVector(const Eigen::VectorXd& values);
NpzArray StoreCounters(const std::vector<int>& values);

// The values under "train/`name`"; throws Error if the array is missing or its size is not `size`.
Eigen::VectorXd LoadVector(const StateArrays& state, const std::string& name, Eigen::Index size);
std::vector<int> LoadCounters(const StateArrays& state, const std::string& name, std::size_t size);

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_STATE_ARRAYS_H_
