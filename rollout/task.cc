// SPDX-License-Identifier: Apache-2.0
#include "rollout/task.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "rollout/task_fields.h"
#include "twin/atomic_file.h"
#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

// The largest that a task may ask for.
constexpr std::size_t kMostCells = 1000000;
constexpr double kMostRate = 10000;    // Hz
constexpr int kMostFrames = 10000000;  // of an episode, or of its settling

// Where a task says nothing: enough that another seed is another episode.
constexpr double kNoise = 0.002, kNoiseYaw = 1;  // m, degrees

std::string InFolder(const std::string& folder, const std::string& file) {
  return (std::filesystem::path(folder) / file).string();
}

int CountOr(const JsonFields& fields, const std::string& key, int missing, int least) {
  const int count = fields.Has(key) ? fields.Count(key) : missing;
  if (count < least) fields.Fail(key, fmt::format("must be {} or more", least));
  if (count > kMostFrames) fields.Fail(key, fmt::format("must be {} or less", kMostFrames));
  return count;
}

std::string TextOr(const JsonFields& fields, const std::string& key, const std::string& missing) {
  return fields.Has(key) ? fields.Text(key) : missing;
}

Eigen::VectorXd VectorOf(const JsonFields& fields, const std::string& key) {
  const std::vector<double> numbers = fields.Numbers(key);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

void ReadCartesian(const JsonFields& fields, RobotOptions* robot) {
  robot->target = fields.Text("target");
  robot->hand = fields.Text("hand");
  const auto fingers = static_cast<Eigen::Index>(robot->actuators.size());
  if (fingers > 0) {
    robot->open = VectorOf(fields, "open");
    robot->closed = VectorOf(fields, "closed");
    if (robot->open.size() != fingers) fields.Fail("open", "must have one number an actuator");
    if (robot->closed.size() != fingers) fields.Fail("closed", "must have one number an actuator");
  }
  robot->speed = PositiveNumber(fields, "speed", robot->speed);
  robot->turn_speed = Radians(PositiveNumber(fields, "turn_speed", 180));
  robot->gripper_speed = PositiveNumber(fields, "gripper_speed", robot->gripper_speed);
}

RobotOptions ReadRobot(const JsonFields& fields) {
  fields.ExpectOnly({"kind", "target", "hand", "actuators", "open", "closed", "home", "speed",
                     "turn_speed", "gripper_speed"});
  RobotOptions robot;
  const std::string kind = TextOr(fields, "kind", "cartesian");
  if (kind != "cartesian" && kind != "joints") fields.Fail("kind", "must be cartesian or joints");
  if (fields.Has("actuators")) robot.actuators = fields.Texts("actuators");
  if (kind == "cartesian") {
    ReadCartesian(fields, &robot);
  } else {
    robot.kind = RobotKind::kJoints;
    if (robot.actuators.empty()) fields.Fail("kind", "is joints, but there are no actuators");
  }
  if (fields.Has("home")) robot.home = VectorOf(fields, "home");
  if (robot.home.size() > 0 && robot.home.size() != robot.action_size()) {
    fields.Fail("home", fmt::format("must have {} numbers", robot.action_size()));
  }
  return robot;
}

std::vector<double> GridOr(const JsonFields& fields, const std::string& key) {
  if (!fields.Has(key)) return {0};
  std::vector<double> numbers = fields.Numbers(key);
  if (numbers.empty()) fields.Fail(key, "must not be empty");
  return numbers;
}

double NoiseOr(const JsonFields& fields, const std::string& key, double missing) {
  if (!fields.Has(key)) return missing;
  const double noise = FiniteNumber(fields, key);
  if (noise < 0) fields.Fail(key, "must be 0 or more");
  return noise;
}

StartOptions ReadStarts(const JsonFields& fields) {
  fields.ExpectOnly({"x", "y", "yaw", "noise_xy", "noise_yaw"});
  StartOptions starts;
  starts.x = GridOr(fields, "x");
  starts.y = GridOr(fields, "y");
  starts.yaw = GridOr(fields, "yaw");
  const double cells = static_cast<double>(starts.x.size()) * static_cast<double>(starts.y.size()) *
                       static_cast<double>(starts.yaw.size());
  if (cells > kMostCells) {
    fields.Fail("x", fmt::format("times y and yaw makes {:.3g} cells, expected {} or fewer", cells,
                                 kMostCells));
  }
  for (double& yaw : starts.yaw) yaw = Radians(yaw);
  starts.noise_xy = NoiseOr(fields, "noise_xy", kNoise);
  starts.noise_yaw = Radians(NoiseOr(fields, "noise_yaw", kNoiseYaw));
  return starts;
}

SuccessOptions ReadSuccess(const JsonFields& fields, int frames) {
  SuccessOptions success;
  success.rule = fields.Text("rule");
  success.body = TextOr(fields, "body", "");
  success.from_frame = CountOr(fields, "from_frame", 0, 0);
  success.at_least = CountOr(fields, "at_least", 1, 1);
  if (success.from_frame > frames - success.at_least) {
    fields.Fail("from_frame", fmt::format("and at_least do not fit into {} frames", frames));
  }
  nlohmann::ordered_json numbers = nlohmann::ordered_json::parse(fields.Dump());
  for (const char* key : {"rule", "body", "from_frame", "at_least"}) numbers.erase(key);
  success.numbers = numbers.dump();
  return success;
}

void ReadTwinAndLevels(const JsonFields& fields, Task* task) {
  task->twin = ReadTwin(InFolder(task->folder, fields.Text("twin")));
  for (const std::string& file : fields.Texts("levels")) {
    task->levels.push_back(InFolder(task->folder, file));
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
  const JsonFields fields(ReadFile(file, std::size_t{1} << 24), file);
  fields.ExpectOnly({"prompt", "scene", "twin", "levels", "object", "rate", "settle", "frames",
                     "robot", "starts", "success", "policy", "cameras", "image"});
  Task task;
  task.folder = folder;
  task.name = NameOfFolder(folder);
  task.prompt = TextOr(fields, "prompt", "");
  task.scene = InFolder(folder, TextOr(fields, "scene", "scene.xml"));
  ReadTwinAndLevels(fields, &task);
  if (fields.Has("object")) task.object = ReadPose(fields.Object("object"));
  task.rate = PositiveNumber(fields, "rate", task.rate);
  if (task.rate > kMostRate) fields.Fail("rate", fmt::format("must be {} Hz or less", kMostRate));
  task.settle = CountOr(fields, "settle", task.settle, 0);
  task.frames = CountOr(fields, "frames", 0, 1);
  task.robot = ReadRobot(fields.Object("robot"));
  if (fields.Has("starts")) task.starts = ReadStarts(fields.Object("starts"));
  task.success = ReadSuccess(fields.Object("success"), task.frames);
  task.policy = TextOr(fields, "policy", "");
  ReadCameras(fields, &task);
  return task;
}

}  // namespace physpring
