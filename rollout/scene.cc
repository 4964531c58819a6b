// SPDX-License-Identifier: Apache-2.0
#include "rollout/scene.h"

#include <array>

#include "rollout/mujoco_log.h"
#include "twin/error.h"

namespace physpring {

ModelPtr LoadScene(const std::string& path, std::vector<std::string>* warnings) {
  std::array<char, 1024> message{};
  mjModel* model = nullptr;
  CatchMujoco(
      path, [&] { model = mj_loadXML(path.c_str(), nullptr, message.data(), message.size()); },
      warnings);
  if (!model) throw Error(path + ": " + OneLine(message.data()));
  return ModelPtr(model);
}

DataPtr MakeData(const mjModel& model) {
  mjData* data = nullptr;
  CatchMujoco([&] { data = mj_makeData(&model); });
  if (!data) throw Error("MuJoCo: not enough memory for the scene's data");
  return DataPtr(data);
}

void Step(const mjModel& model, mjData* data) {
  const std::vector<std::string> warnings = CatchMujoco([&] { mj_step(&model, data); });
  if (!warnings.empty()) throw Error("MuJoCo: " + warnings.front());
}

}  // namespace physpring
