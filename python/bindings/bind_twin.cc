// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "jobs/checkpoint.h"
#include "jobs/export.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "report/info_text.h"
#include "report/material_text.h"
#include "twin/contact_law.h"
#include "twin/effects/effect_json.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/lift.h"
#include "twin/stability.h"

namespace physpring {
namespace {

using Springs = nb::ndarray<nb::numpy, int>;

GivenTwin LoadTwin(const std::filesystem::path& path) {
  GivenTwin given{path.string(), ReadTwin(path.string())};
  if (!IsFinished(given.twin)) Warn({given.path + ": its training is not finished"});
  return given;
}

std::string ReprOfTwin(const GivenTwin& given) {
  std::string levels;
  for (const TwinLevel& level : given.twin.levels) {
    levels += fmt::format("{}{} nodes, {} springs", levels.empty() ? "" : "; ",
                          level.system.node_count(), level.system.spring_count());
  }
  return fmt::format("<physpring.Twin '{}': {}>", given.twin.name, levels);
}

// What is left open of it, or None.
nb::object PosteriorOf(const GivenTwin& given) {
  const Posterior& posterior = given.twin.posterior;
  if (posterior.empty()) return nb::none();
  nb::dict arrays;
  arrays["stiffness"] = CopyOf(posterior.stiffness);
  arrays["loss_time"] = CopyOf(posterior.loss_time);
  arrays["drag"] = CopyOf(posterior.drag);
  arrays["contact"] = CopyOf(posterior.contact);
  arrays["effects"] = CopyOf(posterior.effects);
  return arrays;
}

nb::object FitErrorsOf(const GivenTwin& given) {
  if (!given.twin.fit_errors) return nb::none();
  const FitErrors& errors = *given.twin.fit_errors;
  nb::dict values;
  values["track"] = errors.track;
  values["motionless"] = errors.motionless;
  values["later"] = errors.later;
  values["noise"] = errors.noise;
  values["correlation"] = errors.correlation;
  return values;
}

std::vector<GivenTwin> SamplesOf(const GivenTwin& given, int count, std::uint64_t seed) {
  constexpr int kMost = 10000;
  if (count < 0 || count > kMost) {
    throw Error(fmt::format("n is {}, expected 0 to {}", count, kMost));
  }
  if (count == 0) return {};
  const Twin& twin = Checked(given);
  std::vector<GivenTwin> samples;
  for (int i = 0; i < count; ++i) {
    samples.push_back({fmt::format("{}, sample {}", given.path, i), SampleOf(twin, seed, i)});
  }
  std::vector<std::string> warnings;
  for (const std::string& warning : WarningsOfSamples(twin)) {
    warnings.push_back(given.path + ": " + warning);
  }
  Warn(warnings);
  return samples;
}

// A property that is a view of a member, which may be written to; to set it copies numbers.
template <class Member>
void AddView(nb::class_<TwinLevel>* level, const char* name, Member member, const char* doc) {
  const auto get = [member](nb::handle self) {
    return ViewOf(&(nb::cast<TwinLevel&>(self).system.*member), self);
  };
  const auto set = [get](nb::handle self, nb::handle value) {
    nb::module_::import_("numpy").attr("copyto")(nb::cast(get(self), nb::rv_policy::reference),
                                                 value);
  };
  level->def_prop_rw(name, get, set, doc, nb::for_getter(kHasOwner));
}

void BindLevel(nb::module_& module) {
  nb::class_<TwinLevel> level(
      module, "Level",
      "One level of a twin: an explicit spring-mass system. Arrays are views: what is written to\n"
      "them changes the twin. Spring e joins columns (a, b) of `position`, nodes first, "
      "controllers\n"
      "after them, and pulls a towards b with F = k (|d| - L) + c (v_b - v_a).n, d = x_b - x_a.");
  AddView(&level, "position", &SpringMassSystem::position,
          "(nodes + controllers, 3) reference configuration, m.");
  AddView(&level, "mass", &SpringMassSystem::mass, "(nodes,) kg.");
  AddView(&level, "stiffness", &SpringMassSystem::stiffness, "(springs,) k, N/m.");
  AddView(&level, "rest_length", &SpringMassSystem::rest_length, "(springs,) L, m.");
  AddView(&level, "dashpot", &SpringMassSystem::dashpot, "(springs,) c, N s/m.");
  AddView(&level, "contact_radius", &SpringMassSystem::contact_radius,
          "(nodes,) distance from a surface at which a node touches it, m.");
  level.def_prop_ro(
      "springs",
      [](nb::handle self) {
        auto& springs = nb::cast<TwinLevel&>(self).system.springs;
        return nb::ndarray<nb::numpy, const int>(springs.data()->data(), {springs.size(), 2}, self);
      },
      "(springs, 2) the columns of `position` that each joins.", kHasOwner);
  level.def_prop_rw(
      "drag", [](const TwinLevel& self) { return self.system.drag; },
      [](TwinLevel& self, double drag) { self.system.drag = drag; }, "1/s: v <- v exp(-h drag).");
  level.def_prop_ro("node_count", [](const TwinLevel& self) { return self.system.node_count(); });
  level.def_prop_ro("spring_count",
                    [](const TwinLevel& self) { return self.system.spring_count(); });
  level.def_prop_ro("controller_count",
                    [](const TwinLevel& self) { return self.system.controllers; });
  level.def_prop_ro(
      "substeps_per_second", [](const TwinLevel& self) { return self.substeps_per_second; },
      "With which it was trained.");
  level.def_prop_ro(
      "dashpot_stages", [](const TwinLevel& self) { return self.system.dashpot_stages; },
      "Into how many stages a sub-step takes the dashpots.");
  level.def_prop_ro(
      "assignment", [](const TwinLevel& self) { return FrozenCopyOf(self.assignment); },
      "(nodes of the level below,) the node of this level; empty at level 0.", kHasOwner);
  level.def_prop_ro(
      "contact",
      [](const TwinLevel& self) {
        nb::dict contact;
        for (const auto& coefficient : kContactCoefficients<double>) {
          contact[coefficient.name] = self.system.contact.surface.*coefficient.member;
          contact[coefficient.object_name] = self.system.contact.object.*coefficient.member;
        }
        return contact;
      },
      "The coefficients of contact.");
  level.def_prop_ro("_effects_json",
                    [](const TwinLevel& self) { return EffectsToJson(self.system.effects); });
  level.def(
      "largest_timestep",
      [](const TwinLevel& self) {
        self.system.Validate("the level");
        return ComputeStabilityBound(self.system).timestep;
      },
      "The largest stable sub-step, s (no safety taken off).");
}

}  // namespace

const Twin& Checked(const GivenTwin& given) {
  for (std::size_t i = 0; i < given.twin.levels.size(); ++i) {
    given.twin.levels[i].system.Validate(fmt::format("{}: level {}", given.path, i));
  }
  return given.twin;
}

void BindTwin(nb::module_& module) {
  BindLevel(module);
  using Class = GivenTwin;
  nb::class_<Class> twin(module, "Twin",
                         "The learned spring-mass systems of one object, from dense (level 0) to "
                         "coarse.");
  twin.def_static("load", &LoadTwin, nb::arg("path"),
                  "Reads NAME.twin.npz. Raises Error for anything malformed.");
  twin.def(
      "save",
      [](Class& self, const std::filesystem::path& path) {
        WriteTwin(self.twin, path.string());
        self.path = path.string();
      },
      nb::arg("path"),
      "Writes NAME.twin.npz, whole or not at all. Raises Error, and writes nothing, for a twin "
      "that\n"
      "`load` would refuse.");
  twin.def(
      "copy", [](const Class& self) { return Class(self); }, "One that shares nothing.");
  twin.def_prop_ro(
      "levels",
      [](nb::handle self) {
        nb::list levels;
        for (TwinLevel& level : nb::cast<Class&>(self).twin.levels) {
          levels.append(nb::cast(&level, nb::rv_policy::reference_internal, self));
        }
        return levels;
      },
      "list of Level.");
  twin.def_prop_ro("path", [](const Class& self) { return self.path; });
  twin.def_prop_ro("name", [](const Class& self) { return self.twin.name; });
  twin.def_prop_ro(
      "fps", [](const Class& self) { return self.twin.fps; },
      "Frames per second of what it was trained on.");
  twin.def_prop_ro("seed", [](const Class& self) { return self.twin.seed; });
  twin.def_prop_ro(
      "points", [](const Class& self) { return self.twin.points; },
      "How many of level 0's nodes are measured points, the first ones.");
  twin.def_prop_ro("controller_velocity",
                   [](const Class& self) { return self.twin.controller_velocity; });
  twin.def_prop_ro(
      "gravity", [](const Class& self) { return CopyOf(Eigen::VectorXd(self.twin.gravity)); },
      kHasOwner);
  twin.def_prop_ro(
      "ground",
      [](const Class& self) -> std::optional<NumpyDoubles> {
        if (!self.twin.ground.plane) return std::nullopt;
        return CopyOf(Eigen::VectorXd(*self.twin.ground.plane));
      },
      "(4,) a, b, c, d of the plane a x + b y + c z = d, or None.", kHasOwner);
  twin.def_prop_ro("clock_offset", [](const Class& self) { return self.twin.clock_offset; });
  twin.def_prop_ro("force_scale", [](const Class& self) { return self.twin.force_scale; });
  twin.def_prop_ro(
      "fit_errors", &FitErrorsOf,
      "How well level 0 predicted what it was trained on, a dict, or None where the file does not\n"
      "say: `track`, `motionless` and `later` (None without later frames), mean distances in m;\n"
      "`noise` of a coordinate, m; `correlation` of the errors of one frame and the next.");
  twin.def_prop_ro("_options_json", [](const Class& self) { return self.twin.options_json; });
  twin.def_prop_ro(
      "trained_on",
      [](const Class& self) {
        std::vector<std::pair<std::string, std::string>> names;
        for (const TrainedOn& one : self.twin.trained_on) names.emplace_back(one.name, one.hash);
        return names;
      },
      "(name, hash) of each recording.");
  twin.def_prop_ro(
      "posterior", &PosteriorOf,
      "What the recordings leave open of level 0, a dict of copies, or None. Each row is a\n"
      "direction by one standard deviation: `stiffness` and `loss_time` (directions, springs),\n"
      "`drag` (directions,) and `contact` (directions, coefficients) are changes of logarithms,\n"
      "`effects` (directions, values of effects) of values.",
      kHasOwner);
  twin.def(
      "sample", &SamplesOf, nb::arg("n"), nb::arg("seed") = 0,
      "n twins that are as likely by the recordings: level 0 drawn from the posterior, the\n"
      "coarser levels with it. Sample i of a seed is the same whatever n is. Warns of what the\n"
      "recordings do not tell; raises Error for a twin without posterior.");
  twin.def("_material_text", [](const Class& self) {
    return self.twin.material ? DescribeMaterial(*self.twin.material) : std::string();
  });
  twin.def(
      "average",
      [](const Class& self, int level, const Numbers<2>& particles) {
        const int nodes = LevelOf(self.twin, 0).system.node_count();
        LevelOf(self.twin, level);
        return CopyOf(
            AverageOverMembers(Checked(self), level, PointsFrom(particles, nodes, "particles")));
      },
      nb::arg("level"), nb::arg("particles"),
      "(nodes, 3) positions or velocities of a level's nodes: the mass-weighted means of their\n"
      "members. `particles`: (nodes of level 0, 3).");
  twin.def(
      "lift",
      [](const Class& self, int level, const Numbers<2>& start, const Numbers<3>& nodes) {
        const int particles = LevelOf(self.twin, 0).system.node_count();
        const Lift lift(Checked(self), level, PointsFrom(start, particles, "start"));
        std::vector<Points> lifted;
        for (const Points& frame :
             FramesFrom(nodes, LevelOf(self.twin, level).system.node_count(), "nodes")) {
          lifted.push_back(lift.Apply(frame));
        }
        return CopyOf(lifted);
      },
      nb::arg("level"), nb::arg("start"), nb::arg("nodes"),
      "(T, nodes of level 0, 3) level 0's particles as the nodes of `level` carry them along.\n"
      "`start`: (nodes of level 0, 3) where they start; `nodes`: (T, nodes of the level, 3).");
  twin.def("__getstate__", [](const Class& self) {
    const std::string file = PackNpz(CheckedArraysOf(self.twin, self.path), self.path);
    return nb::make_tuple(self.path, nb::bytes(file.data(), file.size()));
  });
  twin.def("__setstate__", [](Class& self, const nb::tuple& parts) {
    const auto path = nb::cast<std::string>(parts[0]);
    const auto file = nb::cast<nb::bytes>(parts[1]);
    new (&self)
        Class{path, ParseTwin(ParseNpz(std::string(file.c_str(), file.size()), path), path)};
  });
  twin.def("__copy__", [](const Class& self) { return Class(self); });
  twin.def("__deepcopy__", [](const Class& self, const nb::dict&) { return Class(self); });
  twin.def("__repr__", &ReprOfTwin);
  twin.def("__str__", [](const Class& self) { return DescribeTwin(self.twin); });
}

}  // namespace physpring
