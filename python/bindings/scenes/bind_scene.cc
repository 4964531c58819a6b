// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/bindings/arrays.h"
#include "python/bindings/scenes/scenes.h"
#include "python/bindings/scenes/task_scene.h"
#include "python/bindings/watched_work.h"
#include "rollout/picture_size.h"
#include "twin/error.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

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

}  // namespace

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
      [](Class& self, const std::string& policy, const std::string& policy_adapter) {
        const PolicyChoice choice{policy, policy_adapter, {}};
        const InUse in_use({&self});
        Eigen::VectorXd action;
        if (policy.starts_with("ws://")) {  // it may wait long
          RunWatched(nb::none(), [&](const TellShare& /*tell*/) { action = self.Act(choice); });
        } else {
          const nb::gil_scoped_release unlocked;
          action = self.Act(choice);
        }
        return CopyOf(action);
      },
      nb::arg("policy"), nb::arg("policy_adapter") = "");
  scene.def_prop_ro("sensors", [](const Class& self) {
    nb::dict sensors;
    for (const auto& [name, reading] : Idle(self).episode().observation().sensors) {
      sensors[name.c_str()] = CopyOf(reading);
    }
    return sensors;
  });
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
  module.def(
      "resize_with_pad",
      [](const nb::ndarray<const unsigned char, nb::ndim<3>, nb::c_contig, nb::device::cpu>& pixels,
         int width, int height) {
        if (pixels.shape(2) != 3 || pixels.size() == 0) throw Error("pixels has not 3 colours");
        Image image{static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)), {}};
        image.rgb.assign(pixels.data(), pixels.data() + pixels.size());
        return PixelsOf(ResizeWithPad(image, width, height));
      },
      nb::arg("pixels"), nb::arg("width"), nb::arg("height"));
  module.def("step_all", &StepAll, nb::arg("scenes"), nb::arg("actions"), nb::arg("threads"));
  module.def("reset_all", &ResetAll, nb::arg("scenes"), nb::arg("seeds"), nb::arg("episodes"),
             nb::arg("action_noise"), nb::arg("start_noise"), nb::arg("threads"));
}

}  // namespace physpring
