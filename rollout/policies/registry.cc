// SPDX-License-Identifier: Apache-2.0
#include "rollout/policies/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rollout/policies/cloth_folding.h"
#include "rollout/policies/rope_routing.h"
#include "rollout/policies/t_push.h"
#include "rollout/policies/toy_packing.h"
#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

using Make = std::function<std::unique_ptr<Policy>(const Task&)>;

const std::map<std::string, Make>& Policies() {
  static const std::map<std::string, Make> policies = {
      {"cloth_folding", [](const Task& task) { return std::make_unique<ClothFolding>(task); }},
      {"rope_routing", [](const Task& task) { return std::make_unique<RopeRouting>(task); }},
      {"t_push", [](const Task& task) { return std::make_unique<TPush>(task); }},
      {"toy_packing", [](const Task& task) { return std::make_unique<ToyPacking>(task); }},
  };
  return policies;
}

}  // namespace

std::unique_ptr<Policy> MakeScriptedPolicy(const Task& task) {
  const auto found = Policies().find(task.policy);
  if (found != Policies().end()) return found->second(task);
  std::vector<std::string> names;
  for (const auto& [name, make] : Policies()) names.push_back(name);
  throw Error(fmt::format("{}/task.json: key 'policy' holds {}, expected one of {}", task.folder,
                          Quote(task.policy), fmt::join(names, ", ")));
}

}  // namespace physpring
