// SPDX-License-Identifier: Apache-2.0
#include "trainer/state_arrays.h"

#include <fmt/format.h>

#include "twin/error.h"

namespace physpring {
namespace {

const NpzArray& Find(const StateArrays& state, const std::string& name, std::size_t size) {
  const auto found = state.find("train/" + name);
  if (found == state.end()) {
    throw Error(fmt::format("cannot resume: array 'train/{}' is missing", name));
  }
  if (found->second.size() == size) return found->second;
  throw Error(fmt::format("cannot resume: array 'train/{}' has {} values, expected {}", name,
                          found->second.size(), size));
}

}  // namespace

NpzArray StoreVector(const Eigen::VectorXd& values) {
  return NpzArray::Doubles({static_cast<std::size_t>(values.size())}, values.data());
}

NpzArray StoreCounters(const std::vector<int>& values) {
  return NpzArray::Ints({values.size()}, values.data());
}

Eigen::VectorXd LoadVector(const StateArrays& state, const std::string& name, Eigen::Index size) {
  const std::vector<double> values = Find(state, name, static_cast<std::size_t>(size)).ToDoubles();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), size);
}

std::vector<int> LoadCounters(const StateArrays& state, const std::string& name, std::size_t size) {
  return Find(state, name, size).ToInts();
}

}  // namespace physpring
