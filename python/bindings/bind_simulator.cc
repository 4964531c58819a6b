// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/parameters.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/path_simulator.h"
#include "twin/predict.h"

namespace physpring {
namespace {

// A level of a twin with values of its own, and the simulator of them.
class LevelSimulator {
 public:
  LevelSimulator(const GivenTwin& twin, int level, std::optional<double> fps,
                 std::optional<int> substeps, const std::optional<Numbers<1>>& gravity,
                 const std::optional<Numbers<1>>& ground, bool use_ground, bool single_precision)
      : system_(LevelOf(twin.twin, level).system) {
    options_.fps = fps.value_or(twin.twin.fps);
    if (!(options_.fps > 0) || !std::isfinite(options_.fps)) {
      throw Error(fmt::format("fps is {}, expected a number above 0", options_.fps));
    }
    if (substeps && *substeps < 1) {
      throw Error(fmt::format("substeps is {}, expected 1 or more", *substeps));
    }
    options_.substeps =
        ChooseSubsteps(LevelOf(twin.twin, level), options_.fps, substeps.value_or(0));
    options_.controller_velocity = twin.twin.controller_velocity;
    options_.single_precision = single_precision;
    environment_.gravity =
        gravity ? Eigen::Vector3d(VectorFrom(*gravity, 3, "gravity")) : twin.twin.gravity;
    if (use_ground) environment_.ground = twin.twin.ground.plane;
    if (ground) environment_.ground = PlaneFrom(*ground);
    Rebuild();
  }

  // To be taken with the interpreter's lock: `Set` makes another one.
  std::shared_ptr<const PathSimulator> Get() const { return simulator_; }
  const SpringMassSystem& system() const { return system_; }
  const PathOptions& options() const { return options_; }
  std::vector<NamedNumbers> Parameters() { return ParametersOf(&system_, &environment_); }

  // Sets those that are given. Nothing changes where one is wrong.
  void Set(const nb::dict& values) {
    LevelSimulator changed = *this;
    for (const auto& [key, value] : values) {
      changed.SetOne(nb::cast<std::string>(key), nb::cast<Numbers<1>>(value));
    }
    changed.Rebuild();
    *this = std::move(changed);
  }

  PathStart StartFrom(const std::optional<Numbers<2>>& position,
                      const std::optional<Numbers<2>>& velocity) const {
    const int nodes = system_.node_count();
    return {position ? PointsFrom(*position, nodes, "position")
                     : Points(system_.position.leftCols(nodes)),
            velocity ? PointsFrom(*velocity, nodes, "velocity") : Points(Points::Zero(3, nodes))};
  }
  std::vector<Points> PathFrom(const Numbers<3>& controllers) const {
    return FramesFrom(controllers, system_.controllers, "controllers");
  }

 private:
  static Eigen::Vector4d PlaneFrom(const Numbers<1>& ground) {
    Eigen::Vector4d plane = VectorFrom(ground, 4, "ground");
    const double length = plane.head<3>().norm();
    if (!(length > 0)) throw Error("ground has no normal: its first three numbers are 0");
    return plane / length;
  }

  void SetOne(const std::string& name, const Numbers<1>& value) {
    std::string names;
    for (const NamedNumbers& parameter : Parameters()) {
      if (parameter.name == name) {
        const Eigen::VectorXd numbers =
            VectorFrom(value, static_cast<Eigen::Index>(parameter.size), name.c_str());
        std::copy(numbers.begin(), numbers.end(), parameter.numbers);
        return;
      }
      names += (names.empty() ? "" : ", ") + parameter.name;
    }
    throw Error(fmt::format("parameter '{}' is unknown; there are {}", name, names));
  }

  void Rebuild() { simulator_ = MakePathSimulator(system_, environment_, options_); }

  SpringMassSystem system_;
  Environment environment_;
  PathOptions options_;
  std::shared_ptr<const PathSimulator> simulator_;
};

nb::object NumpyOf(const NamedNumbers& numbers) {
  if (numbers.scalar) return nb::float_(*numbers.numbers);
  return nb::cast(CopyOf(std::vector<double>(numbers.numbers, numbers.numbers + numbers.size)));
}

nb::dict DictOf(const std::vector<NamedNumbers>& all) {
  nb::dict dict;
  for (const NamedNumbers& numbers : all) dict[numbers.name.c_str()] = NumpyOf(numbers);
  return dict;
}

using OptionalPoints = std::optional<Numbers<2>>;

nb::tuple Roll(const LevelSimulator& self, const Numbers<3>& controllers,
               const OptionalPoints& position, const OptionalPoints& velocity) {
  const std::vector<Points> path = self.PathFrom(controllers);
  const PathStart start = self.StartFrom(position, velocity);
  const auto simulator = self.Get();
  PathMotion motion;
  {
    const nb::gil_scoped_release unlocked;
    motion = simulator->Roll(start, path);
  }
  return nb::make_tuple(CopyOf(motion.position), CopyOf(motion.velocity));
}

nb::dict Vjp(const LevelSimulator& self, const Numbers<3>& controllers,
             const Numbers<3>& position_bar, const std::optional<Numbers<3>>& velocity_bar,
             const OptionalPoints& position, const OptionalPoints& velocity) {
  const std::vector<Points> path = self.PathFrom(controllers);
  const PathStart start = self.StartFrom(position, velocity);
  const int nodes = self.system().node_count();
  const auto bar_of = [&](const Numbers<3>& bar, const char* name) {
    std::vector<Points> frames = FramesFrom(bar, nodes, name);
    if (frames.size() == path.size()) return frames;
    throw Error(
        fmt::format("{} has {} frames, but controllers has {}", name, frames.size(), path.size()));
  };
  const std::vector<Points> position_bars = bar_of(position_bar, "position_bar");
  std::vector<Points> velocity_bars;
  if (velocity_bar) velocity_bars = bar_of(*velocity_bar, "velocity_bar");
  const auto simulator = self.Get();
  std::optional<PathGradient> gradient;
  {
    const nb::gil_scoped_release unlocked;
    gradient = simulator->Gradient(start, path, position_bars, velocity_bars);
  }
  nb::dict dict = DictOf(GradientsOf(self.system(), &gradient->system));
  dict["position"] = CopyOf(gradient->position);
  dict["velocity"] = CopyOf(gradient->velocity);
  dict["controllers"] = CopyOf(gradient->controllers);
  return dict;
}

void BindState(nb::module_& module) {
  nb::class_<PathState> state(
      module, "SimulatorState",
      "Where a Simulator is between two frames: to go on from there again.");
  state.def_prop_ro("frame", [](const PathState& self) { return self.path.size() - 1; });
  state.def_prop_ro(
      "controllers", [](const PathState& self) { return CopyOf(self.path.back()); },
      "(controllers, 3) where they are, m.", kHasOwner);
  state.def("__getstate__", [](const PathState& self) {
    return nb::make_tuple(self.fps, CopyOf(self.nodes), CopyOf(self.path));
  });
  state.def("__setstate__", [](PathState& self, const nb::tuple& parts) {
    if (parts.size() != 3) throw Error("a state has three parts");
    const auto fps = nb::cast<double>(parts[0]);
    const auto nodes = nb::cast<Numbers<1>>(parts[1]);
    const auto path = nb::cast<Numbers<3>>(parts[2]);
    new (&self) PathState{fps, std::vector<double>(nodes.data(), nodes.data() + nodes.size()),
                          FramesFrom(path, static_cast<Eigen::Index>(path.shape(1)), "path")};
  });
}

}  // namespace

void BindSimulator(nb::module_& module) {
  BindState(module);
  using Class = LevelSimulator;
  nb::class_<Class> simulator(module, "LevelSimulator");
  simulator.def(
      nb::init<const GivenTwin&, int, std::optional<double>, std::optional<int>,
               const std::optional<Numbers<1>>&, const std::optional<Numbers<1>>&, bool, bool>(),
      nb::arg("twin"), nb::arg("level"), nb::arg("fps").none(), nb::arg("substeps").none(),
      nb::arg("gravity").none(), nb::arg("ground").none(), nb::arg("use_ground"),
      nb::arg("single_precision"));
  simulator.def_prop_ro("substeps", [](const Class& self) { return self.options().substeps; });
  simulator.def_prop_ro("fps", [](const Class& self) { return self.options().fps; });
  simulator.def_prop_ro("node_count", [](const Class& self) { return self.system().node_count(); });
  simulator.def_prop_ro("controller_count",
                        [](const Class& self) { return self.system().controllers; });
  simulator.def_prop_ro(
      "rest_controllers",
      [](const Class& self) {
        return CopyOf(Points(self.system().position.rightCols(self.system().controllers)));
      },
      kHasOwner);
  simulator.def("parameters", [](Class& self) { return DictOf(self.Parameters()); });
  simulator.def("copy", [](const Class& self) { return Class(self); });
  simulator.def("set", &Class::Set, nb::arg("values"));
  simulator.def("roll", &Roll, nb::arg("controllers"), nb::arg("position").none(),
                nb::arg("velocity").none());
  simulator.def("vjp", &Vjp, nb::arg("controllers"), nb::arg("position_bar"),
                nb::arg("velocity_bar").none(), nb::arg("position").none(),
                nb::arg("velocity").none());
  simulator.def(
      "start",
      [](const Class& self, const Numbers<2>& controllers, const OptionalPoints& position,
         const OptionalPoints& velocity) {
        return self.Get()->MakeState(
            self.StartFrom(position, velocity),
            PointsFrom(controllers, self.system().controllers, "controllers"));
      },
      nb::arg("controllers"), nb::arg("position").none(), nb::arg("velocity").none());
  simulator.def(
      "advance",
      [](const Class& self, const PathState& state, const Numbers<2>& controllers) {
        PathState next = state;
        const Points end = PointsFrom(controllers, self.system().controllers, "controllers");
        const auto simulator = self.Get();
        simulator->ExpectOwn(state);
        const nb::gil_scoped_release unlocked;
        simulator->Advance(end, &next);
        return next;
      },
      nb::arg("state"), nb::arg("controllers"));
  simulator.def("expect_own",
                [](const Class& self, const PathState& state) { self.Get()->ExpectOwn(state); });
  simulator.def(
      "nodes",
      [](const Class& self, const PathState& state) {
        self.Get()->ExpectOwn(state);
        const PathStart nodes = self.Get()->Of(state);
        return nb::make_tuple(CopyOf(nodes.position), CopyOf(nodes.velocity));
      },
      nb::arg("state"));
}

}  // namespace physpring
