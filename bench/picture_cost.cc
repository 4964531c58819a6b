// SPDX-License-Identifier: Apache-2.0
// What a 640 x 480 picture of a task costs: with its object drawn as it is exported, and drawn as
// nodes in MuJoCo's default quality. picture_cost TASK [LEVEL] prints medians in ms.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <string_view>
#include <system_error>
#include <vector>

#include "rollout/painter.h"
#include "rollout/plugin_library.h"
#include "rollout/task_model.h"
#include "twin/error.h"

namespace physpring {
namespace {

constexpr int kWidth = 640, kHeight = 480, kPictures = 31;

double MedianMilliseconds(const TaskModel& task_model, PictureQuality quality) {
  const mjModel& model = *task_model.model;
  const DataPtr data = MakeData(model);
  mj_forward(&model, data.get());
  Painter painter(model, quality, kWidth, kHeight);
  const Task& task = *task_model.task;
  const mjvCamera camera = FindCamera(model, task.cameras.at(0), task.scene);
  std::vector<double> taken;
  for (int i = 0; i < kPictures; ++i) {
    const auto start = std::chrono::steady_clock::now();
    painter.Paint(data.get(), camera);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    taken.push_back(1e3 * seconds.count());
  }
  std::nth_element(taken.begin(), taken.begin() + kPictures / 2, taken.end());
  return taken[kPictures / 2];
}

// Nodes in a group that is drawn, and no skin.
void DrawNodes(mjModel* model) {
  constexpr int kNodeGroup = 3;
  std::replace(model->geom_group, model->geom_group + model->ngeom, kNodeGroup, 0);
  for (int skin = 0; skin < model->nskin; ++skin) model->skin_rgba[4 * skin + 3] = 0;
}

void Run(const std::string& folder, int level) {
  LoadPluginLibrary();
  const Task task = ReadTask(folder);
  std::vector<std::string> warnings;
  TaskModel fast = MakeTaskModel(task, level, &warnings);
  PreparePictures(PictureQuality::kFast, kWidth, kHeight, fast.model.get());
  TaskModel nodes = MakeTaskModel(task, level, &warnings);
  PreparePictures(PictureQuality::kHigh, kWidth, kHeight, nodes.model.get());
  DrawNodes(nodes.model.get());
  const double as_exported = MedianMilliseconds(fast, PictureQuality::kFast);
  const double as_nodes = MedianMilliseconds(nodes, PictureQuality::kHigh);
  fmt::print(
      "{} level {}, {} nodes: {:.1f} ms; as nodes in default quality {:.1f} ms, {:.1f} times "
      "as much\n",
      task.name, level, fast.node_count(), as_exported, as_nodes, as_nodes / as_exported);
}

}  // namespace
}  // namespace physpring

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  int level = 0;
  if (argc > 2) {
    const std::string_view text = argv[2];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), level);
    if (error != std::errc() || end != text.data() + text.size()) return 2;
  }
  try {
    physpring::Run(argv[1], level);
  } catch (const physpring::Error& error) {
    fmt::print(stderr, "picture_cost: {}\n", error.what());
    return 1;
  }
}
