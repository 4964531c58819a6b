// SPDX-License-Identifier: Apache-2.0
#include "rollout/task.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "rollout/task_fields.h"
#include "splats/placement.h"
#include "splats/splat_file.h"
#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

// Where a task says nothing: enough that another seed is another episode.
constexpr double kNoise = 0.002, kNoiseYaw = 1;  // m, degrees

// The most that a task may ask for: beyond what anybody waits for, and far from what overflows.
constexpr double kLeastRate = 0.1, kMostRate = 1e4;  // Hz
constexpr int kMostFrames = 100000, kMostCells = 1000000;
constexpr double kMostControl = 1e6;                     // of an actuator, in its unit
constexpr double kMostSpeed = 1000, kMostTurns = 36000;  // m/s or 1/s, degrees/s

std::string InFolder(const std::string& folder, const std::string& file) {
  return (std::filesystem::path(folder) / file).string();
}

// The path of a file that a key names. Messages begin with it, so it is a plain line.
std::string FileOf(const JsonFields& fields, const std::string& key, const std::string& folder,
                   const std::string& file) {
  constexpr std::size_t kLongest = 1000;
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 0x7f; };
  if (file.empty() || file.size() > kLongest || std::filesystem::path(file).is_absolute() ||
      std::any_of(file.begin(), file.end(), is_control)) {
    fields.Fail(key, fmt::format("holds {}, expected a file relative to the folder", Quote(file)));
  }
  return InFolder(folder, file);
}

std::string TextOr(const JsonFields& fields, const std::string& key, const std::string& missing) {
  return fields.Has(key) ? fields.Text(key) : missing;
}

Eigen::VectorXd Controls(const JsonFields& fields, const std::string& key) {
  const std::vector<double> numbers = NumbersBetween(fields, key, -kMostControl, kMostControl);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

void ReadFingers(const JsonFields& fields, RobotOptions* robot) {
  if (robot->fingers == 0) return;
  robot->open = Controls(fields, "open");
  robot->closed = Controls(fields, "closed");
  if (robot->open.size() != robot->fingers) fields.Fail("open", "must have one number a finger");
  if (robot->closed.size() != robot->fingers) {
    fields.Fail("closed", "must have one number a finger");
  }
  for (int i = 0; i < robot->fingers; ++i) {
    if (robot->open[i] == robot->closed[i]) fields.Fail("closed", "must differ from open");
  }
}

void ReadCartesian(const JsonFields& fields, RobotOptions* robot) {
  robot->target = fields.Text("target");
  robot->hand = fields.Text("hand");
  robot->fingers = static_cast<int>(robot->actuators.size());
  robot->speed = PositiveNumberOr(fields, "speed", robot->speed, kMostSpeed);
  robot->turn_speed = Radians(PositiveNumberOr(fields, "turn_speed", 180, kMostTurns));
  robot->gripper_speed =
      PositiveNumberOr(fields, "gripper_speed", robot->gripper_speed, kMostSpeed);
}

RobotOptions ReadRobot(const JsonFields& fields) {
  fields.ExpectOnly({"kind", "target", "hand", "actuators", "open", "closed", "home", "speed",
                     "turn_speed", "gripper_speed", "fingers"});
  RobotOptions robot;
  const std::string kind = TextOr(fields, "kind", "cartesian");
  if (kind != "cartesian" && kind != "joints") fields.Fail("kind", "must be cartesian or joints");
  if (fields.Has("actuators")) robot.actuators = fields.Texts("actuators");
  if (kind == "cartesian") {
    ReadCartesian(fields, &robot);
  } else {
    robot.kind = RobotKind::kJoints;
    if (robot.actuators.empty()) fields.Fail("kind", "is joints, but there are no actuators");
    robot.hand = TextOr(fields, "hand", "");
    const int count = static_cast<int>(robot.actuators.size());
    if (fields.Has("fingers")) robot.fingers = CountBetween(fields, "fingers", 0, count);
  }
  ReadFingers(fields, &robot);
  if (fields.Has("home")) robot.home = Controls(fields, "home");
  if (robot.home.size() > 0 && robot.home.size() != robot.action_size()) {
    fields.Fail("home", fmt::format("must have {} numbers", robot.action_size()));
  }
  return robot;
}

std::vector<double> GridOr(const JsonFields& fields, const std::string& key, double most) {
  if (!fields.Has(key)) return {0};
  std::vector<double> numbers = NumbersBetween(fields, key, -most, most);
  if (numbers.empty()) fields.Fail(key, "must not be empty");
  return numbers;
}

double NoiseOr(const JsonFields& fields, const std::string& key, double missing, double most) {
  return fields.Has(key) ? NumberBetween(fields, key, 0, most) : missing;
}

// `where`: the file, with the key of the starts.
StartOptions ReadStarts(const JsonFields& fields, const std::string& where) {
  fields.ExpectOnly({"x", "y", "yaw", "noise_xy", "noise_yaw"});
  StartOptions starts;
  starts.x = GridOr(fields, "x", kFarthest);
  starts.y = GridOr(fields, "y", kFarthest);
  starts.yaw = GridOr(fields, "yaw", kTurn);
  double cells = 1;  // three counts of a file, exact in a double
  for (const auto* axis : {&starts.x, &starts.y, &starts.yaw}) {
    cells *= static_cast<double>(axis->size());
  }
  if (cells > kMostCells) {
    throw Error(fmt::format("{}: key 'starts' has {} cells, expected at most {}", where, cells,
                            kMostCells));
  }
  for (double& yaw : starts.yaw) yaw = Radians(yaw);
  starts.noise_xy = NoiseOr(fields, "noise_xy", kNoise, kFarthest);
  starts.noise_yaw = Radians(NoiseOr(fields, "noise_yaw", kNoiseYaw, kTurn));
  return starts;
}

SuccessOptions ReadSuccess(const JsonFields& fields, int frames) {
  SuccessOptions success;
  success.rule = fields.Text("rule");
  success.body = TextOr(fields, "body", "");
  if (fields.Has("from_frame")) success.from_frame = fields.Count("from_frame");
  if (fields.Has("at_least")) success.at_least = CountBetween(fields, "at_least", 1, frames);
  if (success.from_frame > frames - success.at_least) {
    fields.Fail("from_frame", fmt::format("and at_least do not fit into {} frames", frames));
  }
  nlohmann::ordered_json numbers = fields.json();
  for (const char* key : {"rule", "body", "from_frame", "at_least"}) numbers.erase(key);
  success.numbers = numbers.dump();
  return success;
}

void ReadTwinAndLevels(const JsonFields& fields, Task* task) {
  task->twin = ReadTwin(FileOf(fields, "twin", task->folder, fields.Text("twin")));
  for (const std::string& file : fields.Texts("levels")) {
    task->levels.push_back(FileOf(fields, "levels", task->folder, file));
  }
  if (task->levels.empty() || task->levels.size() > task->twin.levels.size()) {
    fields.Fail("levels", fmt::format("must name 1 to {} files, as the twin has levels",
                                      task->twin.levels.size()));
  }
}

void ReadCameras(const JsonFields& fields, Task* task) {
  if (fields.Has("cameras")) task->cameras = fields.Texts("cameras");
  if (!fields.Has("image")) return;
  const std::vector<double> size = fields.Numbers("image");
  const auto is_size = [](double pixels) {
    return pixels >= 16 && pixels <= 4096 && pixels == static_cast<int>(pixels);
  };
  if (size.size() != 2 || !std::all_of(size.begin(), size.end(), is_size)) {
    fields.Fail("image", "must be width and height, each 16 to 4096");
  }
  task->width = static_cast<int>(size[0]);
  task->height = static_cast<int>(size[1]);
}

// The splats of `file`, where "scale" and "pose" bring them.
std::shared_ptr<const Splats> ReadPlacedSplats(const JsonFields& fields, const std::string& file) {
  const Pose pose = fields.Has("pose") ? ReadPose(fields.Object("pose")) : Pose{};
  const Placement placement{PositiveNumberOr(fields, "scale", 1, 1e6), pose.orientation,
                            pose.position};
  return std::make_shared<Splats>(Place(ReadSplats(file), placement));
}

TaskSplats ReadTaskSplats(const JsonFields& fields, const std::string& folder) {
  fields.ExpectOnly({"file", "scale", "pose", "background"});
  TaskSplats splats;
  if (fields.Has("background")) {
    const JsonFields background = fields.Object("background");
    background.ExpectOnly({"file", "scale", "pose"});
    splats.background =
        ReadPlacedSplats(background, FileOf(background, "file", folder, background.Text("file")));
    if (!fields.Has("file")) {  // the object has its skin
      fields.ExpectOnly({"background"});
      return splats;
    }
  }
  splats.file = FileOf(fields, "file", folder, fields.Text("file"));
  splats.object = ReadPlacedSplats(fields, splats.file);
  return splats;
}

std::string NameOfFolder(const std::string& folder) {
  const std::filesystem::path path = std::filesystem::path(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

int RobotOptions::action_size() const {
  return kind == RobotKind::kCartesian ? 8 : static_cast<int>(actuators.size());
}

int StartOptions::cells() const { return static_cast<int>(x.size() * y.size() * yaw.size()); }

Task ReadTask(const std::string& folder) {
  const std::string file = InFolder(folder, "task.json");
  const JsonFields fields = ReadJsonFile(file);
  fields.ExpectOnly({"prompt", "scene", "twin", "levels", "object", "rate", "settle", "frames",
                     "robot", "starts", "success", "policy", "policy_adapter", "sensors", "splats",
                     "cameras", "image"});
  Task task;
  task.folder = folder;
  task.name = NameOfFolder(folder);
  task.prompt = TextOr(fields, "prompt", "");
  task.scene = FileOf(fields, "scene", folder, TextOr(fields, "scene", "scene.xml"));
  ReadTwinAndLevels(fields, &task);
  if (fields.Has("object")) task.object = ReadPose(fields.Object("object"));
  if (fields.Has("rate")) task.rate = NumberBetween(fields, "rate", kLeastRate, kMostRate);
  if (fields.Has("settle")) task.settle = CountBetween(fields, "settle", 0, kMostFrames);
  task.frames = CountBetween(fields, "frames", 1, kMostFrames);
  task.robot = ReadRobot(fields.Object("robot"));
  if (fields.Has("starts")) task.starts = ReadStarts(fields.Object("starts"), file);
  task.success = ReadSuccess(fields.Object("success"), task.frames);
  task.policy = TextOr(fields, "policy", "");
  if (fields.Has("policy_adapter")) {
    task.policy_adapter = FileOf(fields, "policy_adapter", folder, fields.Text("policy_adapter"));
  }
  if (fields.Has("sensors")) task.sensors = fields.Texts("sensors");
  if (fields.Has("splats")) task.splats = ReadTaskSplats(fields.Object("splats"), folder);
  ReadCameras(fields, &task);
  return task;
}

}  // namespace physpring
