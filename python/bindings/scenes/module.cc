// SPDX-License-Identifier: Apache-2.0
// The module physpring._scenes: what needs MuJoCo. Its functions are those of the library that the
// process has opened for all (physpring/_mujoco.py), so it is for any 4.0.x.
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/bindings/arrays.h"
#include "python/bindings/scenes/task_scene.h"
#include "python/bindings/watched_work.h"
#include "report/rollout_report.h"
#include "rollout/mujoco_library.h"
#include "rollout/plugin_library.h"
#include "rollout/record.h"
#include "rollout/sweep.h"
#include "trainer/solvers/parallel.h"
#include "twin/error.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

PictureQuality QualityOf(const std::string& word) {
  if (word == "fast") return PictureQuality::kFast;
  if (word == "high") return PictureQuality::kHigh;
  throw Error("quality is '" + word + "', expected 'fast' or 'high'");
}

nb::object PixelsOf(const Image& image) {
  const nb::bytes bytes(image.rgb.data(), image.rgb.size());
  return nb::module_::import_("numpy")
      .attr("frombuffer")(bytes, "uint8")
      .attr("reshape")(nb::make_tuple(image.height, image.width, 3));
}

nb::dict PicturesOf(const std::map<std::string, Image>& images) {
  nb::dict pictures;
  for (const auto& [name, image] : images) pictures[name.c_str()] = PixelsOf(image);
  return pictures;
}

Eigen::VectorXd ActionFrom(const Numbers<1>& array) {
  return Eigen::Map<const Eigen::VectorXd>(array.data(), static_cast<Eigen::Index>(array.size()));
}

void BindTask(nb::module_& module) {
  using Class = TaskAtLevel;
  nb::class_<Class> task(module, "Task");
  task.def_static(
      "load",
      [](const std::string& folder, int level, const std::string& quality, int width, int height) {
        return std::const_pointer_cast<Class>(
            LoadTask(folder, level, QualityOf(quality), width, height));
      },
      nb::arg("folder"), nb::arg("level"), nb::arg("quality"), nb::arg("width"), nb::arg("height"));
  task.def_prop_ro("warnings", [](const Class& self) { return self.warnings; });
  task.def_prop_ro("name", [](const Class& self) { return self.task.name; });
  task.def_prop_ro("prompt", [](const Class& self) { return self.task.prompt; });
  task.def_prop_ro("frames", [](const Class& self) { return self.task.frames; });
  task.def_prop_ro("rate", [](const Class& self) { return self.task.rate; });
  task.def_prop_ro("levels", [](const Class& self) { return self.task.levels.size(); });
  task.def_prop_ro("cameras", [](const Class& self) { return self.task.cameras; });
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

// Scenes that a thread works on, without the interpreter's lock, which it has when this begins and
// ends.
class InUse {
 public:
  explicit InUse(std::vector<TaskScene*> scenes) : scenes_(std::move(scenes)) {
    for (const TaskScene* scene : scenes_) ExpectIdle(*scene);
    for (TaskScene* scene : scenes_) scene->in_use = true;
  }
  ~InUse() {
    for (TaskScene* scene : scenes_) scene->in_use = false;
  }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

  static void ExpectIdle(const TaskScene& scene) {
    if (scene.in_use) throw Error("the environment is at work in another thread");
  }

 private:
  std::vector<TaskScene*> scenes_;
};

const TaskScene& Idle(const TaskScene& scene) {
  InUse::ExpectIdle(scene);
  return scene;
}

void BindScene(nb::module_& module) {
  using Class = TaskScene;
  nb::class_<Class> scene(module, "Scene");
  scene.def("__init__", [](Class* self, std::shared_ptr<TaskAtLevel> task) {
    new (self) Class(std::move(task));
  });
  scene.def(
      "reset",
      [](Class& self, std::uint64_t seed, int episode, double action_noise, double start_noise) {
        const InUse in_use({&self});
        const nb::gil_scoped_release unlocked;
        self.Reset(seed, episode, {action_noise, start_noise});
      },
      nb::arg("seed"), nb::arg("episode"), nb::arg("action_noise"), nb::arg("start_noise"));
  scene.def(
      "reset_at",
      [](Class& self, const Numbers<1>& position, const Numbers<1>& quaternion,
         std::uint64_t seed) {
        const Eigen::VectorXd q = VectorFrom(quaternion, 4, "quaternion");
        const Pose object{VectorFrom(position, 3, "position"),
                          UnitQuaternion(q[0], q[1], q[2], q[3])};
        const InUse in_use({&self});
        const nb::gil_scoped_release unlocked;
        self.ResetAt(object, seed);
      },
      nb::arg("position"), nb::arg("quaternion"), nb::arg("seed"));
  scene.def(
      "step",
      [](Class& self, const Numbers<1>& given) {
        const Eigen::VectorXd action = ActionFrom(given);
        const InUse in_use({&self});
        const nb::gil_scoped_release unlocked;
        self.Step(action);
      },
      nb::arg("action"));
  scene.def("look", [](Class& self) {
    std::map<std::string, Image> images;
    {
      const InUse in_use({&self});
      const nb::gil_scoped_release unlocked;
      images = self.Look();
    }
    return PicturesOf(images);
  });
  scene.def(
      "act",
      [](Class& self, const std::string& policy) {
        const InUse in_use({&self});
        Eigen::VectorXd action;
        if (policy.starts_with("ws://")) {  // it may wait long
          RunWatched(nb::none(), [&](const TellShare& /*tell*/) { action = self.Act(policy); });
        } else {
          const nb::gil_scoped_release unlocked;
          action = self.Act(policy);
        }
        return CopyOf(action);
      },
      nb::arg("policy"));
  scene.def_prop_ro("frame", [](const Class& self) { return Idle(self).episode().frame(); });
  scene.def_prop_ro("over", [](const Class& self) { return Idle(self).episode().over(); });
  scene.def_prop_ro("success", [](const Class& self) { return Idle(self).episode().success(); });
  scene.def_prop_ro("met", [](const Class& self) {
    return Idle(self).episode().verdict().met && Idle(self).episode().counts();
  });
  scene.def_prop_ro("value",
                    [](const Class& self) { return Idle(self).episode().verdict().value; });
  scene.def_prop_ro("met_frames", [](const Class& self) { return Idle(self).record().met_frames; });
  scene.def_prop_ro(
      "robot", [](const Class& self) { return CopyOf(Idle(self).episode().observation().robot); },
      kHasOwner);
  scene.def_prop_ro(
      "particles",
      [](const Class& self) { return CopyOf(Idle(self).episode().observation().particles); },
      kHasOwner);
  scene.def_prop_ro(
      "nodes",
      [](const Class& self) {
        static_cast<void>(Idle(self).episode());
        return CopyOf(self.record().nodes.back());
      },
      kHasOwner);
  scene.def_prop_ro("start", [](const Class& self) {
    const EpisodeStart& start = Idle(self).record().start;
    const Eigen::Quaterniond& q = start.object.orientation;
    return nb::make_tuple(start.episode, CopyOf(Eigen::VectorXd(start.object.position)),
                          CopyOf(Eigen::VectorXd(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()))));
  });
}

// All scenes at once, on threads; the first that fails says so, after all are done.
void StepAll(const std::vector<TaskScene*>& scenes, const Numbers<2>& given, int threads) {
  if (given.shape(0) != scenes.size()) throw Error("actions has not one row for each scene");
  std::vector<Eigen::VectorXd> actions;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    actions.emplace_back(Eigen::Map<const Eigen::VectorXd>(
        given.data() + i * given.shape(1), static_cast<Eigen::Index>(given.shape(1))));
  }
  const InUse in_use(scenes);
  // all or none
  for (std::size_t i = 0; i < scenes.size(); ++i) scenes[i]->ExpectStep(actions[i]);
  const nb::gil_scoped_release unlocked;
  ParallelFor(static_cast<int>(scenes.size()), threads,
              [&](int i) { scenes[i]->Step(actions[i]); });
}

void ResetAll(const std::vector<TaskScene*>& scenes, const std::vector<std::uint64_t>& seeds,
              const std::vector<int>& episodes, double action_noise, double start_noise,
              int threads) {
  const InUse in_use(scenes);
  const nb::gil_scoped_release unlocked;
  ParallelFor(static_cast<int>(scenes.size()), threads, [&](int i) {
    scenes[i]->Reset(seeds.at(i), episodes.at(i), {action_noise, start_noise});
  });
}

nb::tuple SweepTask(const std::string& folder, const std::string& output,
                    const std::vector<int>& levels, const std::string& policy, int first,
                    int episodes, std::uint64_t seed, double action_noise, double start_noise,
                    int threads, bool states) {
  if (!IsPolicy(policy)) {
    throw Error("policy is '" + policy +
                "', expected scripted, random, replay:PATH or ws://HOST:PORT");
  }
  if (first < 0) throw Error("first is below 0, expected the number of an episode");
  Sweep sweep;
  RunWatched(nb::none(), [&](const TellShare& /*tell*/) {
    ExpectMujoco();
    LoadPluginLibrary();
    const Task task = ReadTask(folder);
    SweepOptions options;
    options.levels = levels;
    options.first = first;
    options.episodes = episodes;
    options.seed = seed;
    options.disturbance = {action_noise, start_noise};
    options.policy.text = policy;
    options.threads = threads;
    options.folder = output;
    options.states = states;
    SweepHooks hooks;
    hooks.prepare = [&task](mjModel* model) {
      PreparePictures(PictureQuality::kFast, task.width, task.height, model);
    };
    hooks.make_viewer = [](const TaskModel& model, int /*episode*/,
                           bool images) -> std::unique_ptr<Viewer> {
      if (!images) return nullptr;
      return MakeCameraThread(model, {PictureQuality::kFast, "", {}});
    };
    hooks.stop = [] {
      StopIfRequested();
      return false;
    };
    sweep = RunSweep(task, options, hooks);
    if (!sweep.complete) throw Stopped();
  });
  return nb::make_tuple(sweep.episodes.size(), sweep.warnings);
}

nb::tuple ReportOn(const std::vector<std::string>& folders) {
  const std::vector<JudgedPolicy> policies = ReadPolicies(folders);
  return nb::make_tuple(FormatJson(policies), FormatTables(policies));
}

void Record(const std::string& scene, const std::string& output, double noise, double occlusion,
            double vary, std::uint64_t seed, std::optional<double> duration, double fps,
            const std::map<std::string, double>& effects) {
  ExpectMujoco();
  WriteRecording(
      RecordScene(scene, {noise, occlusion, vary, seed, duration, fps, SceneEffects(effects)}),
      output);
}

}  // namespace
}  // namespace physpring

NB_MODULE(_scenes, module) {
  namespace nb = nanobind;
  using namespace physpring;  // NOLINT
  module.doc() = "The part of physpring's engine that needs MuJoCo.";
  nb::register_exception_translator(
      [](const std::exception_ptr& thrown, void*) {
        const nb::object error = nb::module_::import_("physpring._core").attr("Error");
        try {
          std::rethrow_exception(thrown);
        } catch (const Error& caught) {
          PyErr_SetString(error.ptr(), caught.what());
        } catch (const PolicyError& caught) {
          PyErr_SetString(error.ptr(), caught.what());
        } catch (const PolicyServerError& caught) {
          PyErr_SetString(error.ptr(), caught.what());
        }
      },
      nullptr);
  module.def("expect_mujoco", [] { ExpectMujoco(); });
  module.def("load_plugin", [](const std::string& file) { LoadPluginLibrary(file); });
  BindTask(module);
  BindScene(module);
  module.def("record", &Record, nb::arg("scene"), nb::arg("output"), nb::arg("noise"),
             nb::arg("occlusion"), nb::arg("vary"), nb::arg("seed"), nb::arg("duration").none(),
             nb::arg("fps"), nb::arg("effects"), nb::call_guard<nb::gil_scoped_release>());
  module.def("step_all", &StepAll, nb::arg("scenes"), nb::arg("actions"), nb::arg("threads"));
  module.def("reset_all", &ResetAll, nb::arg("scenes"), nb::arg("seeds"), nb::arg("episodes"),
             nb::arg("action_noise"), nb::arg("start_noise"), nb::arg("threads"));
  module.def("sweep", &SweepTask, nb::arg("task"), nb::arg("output"), nb::arg("levels"),
             nb::arg("policy"), nb::arg("first"), nb::arg("episodes"), nb::arg("seed"),
             nb::arg("action_noise"), nb::arg("start_noise"), nb::arg("threads"),
             nb::arg("states"));
  module.def(
      "is_finished",
      [](const std::string& folder, int level, int episode) {
        return ReadEpisode(folder, level, episode).has_value();
      },
      nb::arg("folder"), nb::arg("level"), nb::arg("episode"));
  module.def("report", &ReportOn, nb::arg("folders"));
}
