// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/bindings/arrays.h"
#include "python/bindings/scenes/scenes.h"
#include "python/bindings/scenes/task_scene.h"
#include "twin/error.h"

namespace physpring {
namespace {

PictureQuality QualityOf(const std::string& word) {
  if (word == "fast") return PictureQuality::kFast;
  if (word == "high") return PictureQuality::kHigh;
  throw Error("quality is '" + word + "', expected 'fast' or 'high'");
}

}  // namespace

void BindTask(nb::module_& module) {
  using Class = TaskAtLevel;
  nb::class_<Class> task(module, "Task");
  task.def_static(
      "load",
      [](const std::string& folder, int level, const std::string& quality, int width, int height,
         bool vary_looks, const std::string& sample) {
        return std::const_pointer_cast<Class>(
            LoadTask(folder, level, {QualityOf(quality), width, height, vary_looks, sample}));
      },
      nb::arg("folder"), nb::arg("level"), nb::arg("quality"), nb::arg("width"), nb::arg("height"),
      nb::arg("vary_looks") = false, nb::arg("sample") = "");
  task.def_prop_ro("warnings", [](const Class& self) { return self.warnings; });
  task.def_prop_ro("name", [](const Class& self) { return self.task.name; });
  task.def_prop_ro("prompt", [](const Class& self) { return self.task.prompt; });
  task.def_prop_ro("frames", [](const Class& self) { return self.task.frames; });
  task.def_prop_ro("rate", [](const Class& self) { return self.task.rate; });
  task.def_prop_ro("levels", [](const Class& self) { return self.task.levels.size(); });
  task.def_prop_ro("cameras", [](const Class& self) { return self.task.cameras; });
  task.def_prop_ro("sensors", [](const Class& self) {  // names, and how many numbers
    std::vector<std::pair<std::string, int>> sensors;
    for (std::size_t i = 0; i < self.model.sensors.size(); ++i) {
      const int size = self.model.model->sensor_dim[self.model.sensors[i]];
      sensors.emplace_back(self.task.sensors[i], size);
    }
    return sensors;
  });
  task.def_prop_ro("width", [](const Class& self) { return self.task.width; });
  task.def_prop_ro("height", [](const Class& self) { return self.task.height; });
  task.def_prop_ro("action_size", [](const Class& self) { return self.task.robot.action_size(); });
  task.def_prop_ro("at_least", [](const Class& self) { return self.task.success.at_least; });
  task.def_prop_ro("cells", [](const Class& self) { return self.task.starts.cells(); });
  task.def_prop_ro("particle_count",
                   [](const Class& self) { return self.task.twin.levels[0].system.node_count(); });
  task.def_prop_ro("node_count", [](const Class& self) { return self.model.node_count(); });
  task.def_prop_ro("cartesian",
                   [](const Class& self) { return self.task.robot.kind == RobotKind::kCartesian; });
  task.def_prop_ro("robot_size", [](const Class& self) {
    return self.task.robot.kind == RobotKind::kCartesian
               ? 8
               : static_cast<int>(self.model.joint_qpos.size());
  });
  task.def_prop_ro(
      "control_range",
      [](const Class& self) {
        std::vector<double> numbers;
        const mjModel& model = *self.model.model;
        for (const int actuator : self.model.actuators) {
          const bool limited = model.actuator_ctrllimited[actuator] != 0;
          for (int end = 0; end < 2; ++end) {
            const double infinite = end == 0 ? -1e3 : 1e3;
            numbers.push_back(limited ? model.actuator_ctrlrange[2 * actuator + end] : infinite);
          }
        }
        return CopyOf(numbers);
      },
      kHasOwner);
}

}  // namespace physpring
