// SPDX-License-Identifier: Apache-2.0
#include "rollout/task_model.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "rollout/mujoco_log.h"
#include "rollout/scene_spec.h"
#include "splats/placement.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/npz.h"
#include "twin/quote.h"

namespace physpring {
namespace {

constexpr const char* kPrefix = "object_";  // what the level's names begin with in the scene

// The body that holds the nodes, in the scene: the level's first one.
std::string ObjectBody(mjSpec* level, const std::string& file) {
  const mjsBody* world = mjs_findBody(level, "world");
  mjsElement* first = world ? mjs_firstChild(world, mjOBJ_BODY, 0) : nullptr;
  if (!first) throw Error(file + ": has no body, expected a level of a twin");
  return std::string(kPrefix) + mjs_getString(mjs_getName(first));
}

// Attaches `level` to the world of `scene`, in a new frame.
void Attach(const Pose& pose, const std::string& file, mjSpec* level, mjSpec* scene) {
  bool attached = false;
  CatchMujoco([&] {
    mjsFrame* frame = mjs_addFrame(mjs_findBody(scene, "world"), nullptr);
    const Eigen::Quaterniond& q = pose.orientation;
    const double quaternion[] = {q.w(), q.x(), q.y(), q.z()};
    mju_copy3(frame->pos, pose.position.data());
    mju_copy4(frame->quat, quaternion);
    attached = mjs_attach(frame->element, level->element, kPrefix, "") != nullptr;
  });
  if (!attached) {
    throw Error(
        fmt::format("{}: cannot be attached to the scene: {}", file, OneLine(mjs_getError(scene))));
  }
}

ModelPtr Compile(const std::string& file, mjSpec* scene, std::vector<std::string>* warnings) {
  mjModel* model = nullptr;
  CatchMujoco(
      file, [&] { model = mj_compile(scene, nullptr); }, warnings);
  if (model) return ModelPtr(model);
  const std::string last = warnings->empty() ? "" : "; " + warnings->back();
  throw Error(fmt::format("{}: {}{}", file, OneLine(mjs_getError(scene)), last));
}

int Find(const mjModel& model, mjtObj kind, const std::string& name, const std::string& where) {
  const int id = mj_name2id(&model, kind, name.c_str());
  if (id >= 0) return id;
  throw Error(fmt::format("{}: the scene has no {} {}", where, mju_type2Str(kind), Quote(name)));
}

void FindNodes(const std::string& body, const std::string& file, TaskModel* made) {
  const mjModel& model = *made->model;
  const int parent = mj_name2id(&model, mjOBJ_BODY, body.c_str());
  std::vector<int> nodes;
  for (int child = parent + 1; child < model.nbody; ++child) {
    if (model.body_parentid[child] == parent && model.body_jntnum[child] == 3) {
      nodes.push_back(child);
    }
  }
  const SpringMassSystem& system = LevelOf(made->task->twin, made->level).system;
  if (static_cast<int>(nodes.size()) != system.node_count()) {
    throw Error(fmt::format("{}: has {} nodes, but level {} of the twin has {}", file, nodes.size(),
                            made->level, system.node_count()));
  }
  made->reference.resize(3, system.node_count());
  for (int i = 0; i < system.node_count(); ++i) {
    made->reference.col(i) = Eigen::Map<const Eigen::Vector3d>(model.body_pos + 3 * nodes[i]);
    made->node_qpos.push_back(model.jnt_qposadr[model.body_jntadr[nodes[i]]]);
  }
  constexpr double kSame = 1e-9;  // m
  const double apart =
      (made->reference - system.position.leftCols(system.node_count())).cwiseAbs().maxCoeff();
  if (apart > kSame) {
    throw Error(
        fmt::format("{}: its nodes are up to {:.2g} m from those of level {} of the twin; "
                    "it was not exported from it",
                    file, apart, made->level));
  }
  const double* q = model.body_quat + 4 * parent;
  made->parent.position = Eigen::Map<const Eigen::Vector3d>(model.body_pos + 3 * parent);
  made->parent.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
}

void FindRobot(const std::string& where, TaskModel* made) {
  const mjModel& model = *made->model;
  const RobotOptions& robot = made->task->robot;
  if (robot.kind == RobotKind::kCartesian) {
    made->target = model.body_mocapid[Find(model, mjOBJ_BODY, robot.target, where)];
    if (made->target < 0) {
      throw Error(
          fmt::format("{}: robot.target {} is not a mocap body", where, Quote(robot.target)));
    }
  }
  if (!robot.hand.empty()) made->hand = Find(model, mjOBJ_SITE, robot.hand, where);
  for (const std::string& name : robot.actuators) {
    const int actuator = Find(model, mjOBJ_ACTUATOR, name, where);
    made->actuators.push_back(actuator);
    const bool drives_joint = model.actuator_trntype[actuator] == mjTRN_JOINT;
    if (robot.kind == RobotKind::kJoints && !drives_joint) {
      throw Error(fmt::format("{}: actuator {} does not drive a joint", where, Quote(name)));
    }
    const int joint = model.actuator_trnid[2 * actuator];
    made->joint_qpos.push_back(drives_joint ? model.jnt_qposadr[joint] : -1);
  }
}

// Whether the object's splats are where its nodes are.
void CheckSplats(const Task& task, int level, std::vector<std::string>* warnings) {
  if (!task.splats.object) return;
  const SpringMassSystem& system = LevelOf(task.twin, level).system;
  const Points nodes = system.position.leftCols(system.node_count());
  const auto elsewhere = WarningsOf(CheckPlacement(*task.splats.object, nodes), task.splats.file);
  warnings->insert(warnings->end(), elsewhere.begin(), elsewhere.end());
}

std::string Numbers(const Pose& pose) {
  const Eigen::Vector3d& p = pose.position;
  const Eigen::Quaterniond& q = pose.orientation;
  return fmt::format("pos=\"{} {} {}\" quat=\"{} {} {} {}\"", p.x(), p.y(), p.z(), q.w(), q.x(),
                     q.y(), q.z());
}

}  // namespace

Points TaskModel::NodesIn(const mjData& data) const {
  Points local = reference;
  for (int i = 0; i < node_count(); ++i) {
    local.col(i) += Eigen::Map<const Eigen::Vector3d>(data.qpos + node_qpos[i]);
  }
  return parent.ToWorld(local);
}

TaskModel MakeTaskModel(const Task& task, int level, std::vector<std::string>* warnings) {
  if (level < 0 || level >= static_cast<int>(task.levels.size())) {
    throw Error(
        fmt::format("{}: has levels 0 to {}, not {}", task.folder, task.levels.size() - 1, level));
  }
  const std::string& file = task.levels[level];
  const SpecPtr scene = ParseSpec(task.scene, warnings);
  const SpecPtr object = ParseSpec(file, warnings);
  const std::string body = ObjectBody(object.get(), file);
  Attach(task.object, file, object.get(), scene.get());

  TaskModel made;
  made.task = &task;
  made.level = level;
  made.model = Compile(task.scene, scene.get(), warnings);
  made.steps = FitTimestep(task.rate, made.model.get());
  FindNodes(body, file, &made);
  const std::string where = task.folder + "/task.json";
  FindRobot(where, &made);
  if (!task.success.body.empty()) {
    made.success_body = Find(*made.model, mjOBJ_BODY, task.success.body, where);
  }
  for (const std::string& sensor : task.sensors) {
    made.sensors.push_back(Find(*made.model, mjOBJ_SENSOR, sensor, where));
  }
  for (const std::string& camera : task.cameras) Find(*made.model, mjOBJ_CAMERA, camera, where);
  CheckSplats(task, level, warnings);
  made.success = MakeSuccessRule(task);
  return made;
}

std::string HashModel(const mjModel& model) {
  // the number of a plugin depends on what else the process has loaded: its name stands for it
  const ModelPtr copy(mj_copyModel(nullptr, &model));
  std::string names;
  for (int i = 0; i < copy->nplugin; ++i) {
    names += std::string(mjp_getPluginAtSlot(copy->plugin[i])->name) + "\n";
    copy->plugin[i] = 0;
  }
  const mjtSize size = mj_sizeModel(copy.get());
  std::string bytes(static_cast<std::size_t>(size), '\0');
  mj_saveModel(copy.get(), nullptr, bytes.data(), size);
  return HashBytes(names + bytes);
}

std::string FormatSceneFile(const Task& task, int level) {
  const auto absolute = [](const std::string& path) {
    return std::filesystem::absolute(path).lexically_normal().string();
  };
  return fmt::format(
      "<mujoco model=\"{0} level {1}\">\n"
      "  <include file=\"{2}\"/>\n"
      "  <asset>\n    <model name=\"object\" file=\"{3}\"/>\n  </asset>\n"
      "  <worldbody>\n    <frame {4}>\n      <attach model=\"object\" prefix=\"{5}\"/>\n"
      "    </frame>\n  </worldbody>\n</mujoco>\n",
      task.name, level, absolute(task.scene), absolute(task.levels.at(level)), Numbers(task.object),
      kPrefix);
}

}  // namespace physpring
