// SPDX-License-Identifier: Apache-2.0
// The text of a task.json beside a small twin, up to where its scene would be compiled.
#include "rollout/task.h"

#include <limits>
#include <stdexcept>

#include "rollout/policies/registry.h"
#include "rollout/start.h"
#include "rollout/success_rule.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/small_twin.h"

namespace physpring {
namespace {

const std::string& TaskFolder() {
  static const std::string folder = [] {
    Twin twin = SmallTwin(1);
    twin.levels[0].system.springs.resize(8);  // a small file is read faster
    SpringMassSystem& system = twin.levels[0].system;
    system.stiffness.conservativeResize(8);
    system.rest_length.conservativeResize(8);
    system.dashpot.conservativeResize(8);
    WriteTwin(twin, FuzzFolder() + "/t.npz");
    return FuzzFolder();
  }();
  return folder;
}

void Use(const Task& task) {
  for (const int episode : {0, 1, std::numeric_limits<int>::max()}) {
    const EpisodeStart start = StartOf(task, 1, episode, {});
    if (!start.object.position.allFinite()) throw std::logic_error("a start that is not finite");
  }
  const SpringMassSystem& system = task.twin.levels[0].system;
  MakeSuccessRule(task)->Judge(system.position.leftCols(system.node_count()));
  MakeScriptedPolicy(task);
}

}  // namespace
}  // namespace physpring

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace physpring;
  const std::string& folder = TaskFolder();
  WriteFuzzFile(folder + "/task.json", TextOf(data, size));
  MayRefuse(folder, [&] { Use(ReadTask(folder)); });
  return 0;
}

std::vector<std::string> physpring::FuzzSeeds() {
  const std::string head = R"({"twin":"t.npz","levels":["l.xml"],"frames":20,)";
  const std::string box = R"("box":{"position":[0,0,0],"size":[1,0.1,1],"yaw":5})";
  return {
      head +
          R"("prompt":"push","scene":"s.xml","object":{"position":[0,0,1],"quaternion":)"
          R"([1,0,0,0]},"rate":30,"settle":5,"robot":{"target":"t","hand":"h","actuators":["a"],)"
          R"("open":[0],"closed":[1],"home":[0,0,0,1,0,0,0,0],"speed":1,"turn_speed":90,)"
          R"("gripper_speed":1},"starts":{"x":[-0.01,0.01],"y":[0],"yaw":[-5,5],"noise_xy":0.002,)"
          R"("noise_yaw":1},"success":{"rule":"particles_inside","body":"b","from_frame":10,)"
          R"("at_least":2,"fraction":0.5,)" +
          box + R"(},"policy":"toy_packing","cameras":["c"],"image":[64,48]})",
      head + R"("robot":{"kind":"joints","actuators":["a"]},"success":{"rule":"pairs_close",)"
             R"("pairs":[[0,1],[2,3]],"distance":0.02},"policy":"cloth_folding"})",
      head +
          R"("robot":{"target":"t","hand":"h"},"success":{"rule":"springs_through","springs":3,)" +
          box + R"(},"policy":"rope_routing"})",
      head + R"("robot":{"target":"t","hand":"h"},"success":{"rule":"near_target","target":)"
             R"({"position":[0,0,0]},"mean_squared_distance":1e-4},"policy":"t_push"})"};
}
