// SPDX-License-Identifier: Apache-2.0
#include "tests/support/small_task.h"

#include <filesystem>
#include <stdexcept>
#include <vector>

#include "exporter/export.h"
#include "exporter/folder.h"
#include "rollout/policy.h"
#include "tests/support/small_twin.h"
#include "twin/atomic_file.h"
#include "twin/free_twin.h"
#include "twin/npz.h"

namespace physpring {
namespace {

const char* const kScene = R"(
<mujoco model="push">
  <option timestep="0.002" integrator="Euler"/>
  <worldbody>
    <light pos="0 0 2"/>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <camera name="front" pos="0.05 -0.4 0.3" xyaxes="1 0 0 0 0.6 0.8"/>
    <camera name="top" pos="0.05 0.05 0.5"/>
    <body name="target" mocap="true" pos="0.04 -0.06 0.03"/>
    <body name="hand" pos="0.04 -0.06 0.03" gravcomp="1">
      <freejoint/>
      <geom type="box" size="0.05 0.01 0.025" mass="0.2" rgba="0.8 0.3 0.2 1"/>
      <site name="hand"/>
    </body>
    <body name="marker" pos="0 0.1 0"/>
  </worldbody>
  <equality>
    <weld body1="target" body2="hand" solref="0.01 1"/>
  </equality>
</mujoco>
)";

const char* const kTask = R"({
 "prompt": "push the block behind the line",
 "twin": "block.twin.npz",
 "levels": ["level0.xml", "level1.xml", "level2.xml"],
 "object": {"position": [0, 0, 0.006]},
 "settle": 5,
 "frames": 20,
 "robot": {"target": "target", "hand": "hand"},
 "starts": {"x": [-0.01, 0.01], "yaw": [-5, 5], "noise_xy": 0.002, "noise_yaw": 1},
 "success": {"rule": "particles_inside", "body": "marker", "from_frame": 10, "at_least": 2,
             "box": {"position": [0, 0, 0], "size": [1, 0.1, 1]}, "fraction": 0.5},
 "cameras": ["front", "top"],
 "image": [64, 48]
}
)";

}  // namespace

SmallTask::SmallTask() {
  const Twin twin = WithoutControllers(SmallTwin(3));
  ExportOptions options;
  options.springs = SpringKind::kPlugin;
  options.controllers = ControllerKind::kNone;
  WriteFolder(path(), ExportTwin(twin, options, "physpring export").files, false);
  WriteTwin(twin, File("block.twin.npz"));
  WriteFileAtomically(File("scene.xml"), kScene);  // instead of the exporter's
  WriteFileAtomically(File("task.json"), kTask);
}

void SmallTask::Change(const std::string& from, const std::string& to) const {
  std::string text = ReadFile(File("task.json"));
  const std::size_t place = text.find(from);
  if (place == std::string::npos) throw std::runtime_error("task.json does not hold " + from);
  WriteFileAtomically(File("task.json"), text.replace(place, from.size(), to));
}

std::string SmallTask::WriteActions(double way, int frames) const {
  std::vector<double> actions;
  for (int frame = 1; frame <= frames; ++frame) {
    Pose hand;
    hand.position = Eigen::Vector3d(0.04, -0.06 + way * frame / frames, 0.03);
    const Eigen::VectorXd action = CartesianAction(hand, 0);
    actions.insert(actions.end(), action.begin(), action.end());
  }
  WriteNpz({{"actions", NpzArray::Doubles({static_cast<std::size_t>(frames), 8}, actions.data())}},
           File("push.npz"));
  return File("push.npz");
}

}  // namespace physpring
