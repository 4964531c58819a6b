// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/info_text.h"
#include "report/material_text.h"
#include "twin/cone_name.h"
#include "twin/contact_words.h"
#include "twin/effects/effect_json.h"
#include "twin/effects/registry.h"
#include "twin/ground.h"
#include "twin/json_text.h"
#include "twin/level_numbers.h"
#include "twin/stability.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

struct Range {
  double least, median, most;
};

Range RangeOf(const Eigen::VectorXd& values) {
  if (values.size() == 0) return {0, 0, 0};
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  return {sorted.front(), (sorted[(n - 1) / 2] + sorted[n / 2]) / 2, sorted.back()};
}

// "rest_length_m": the key of a number in JSON.
std::string KeyOf(const std::string& name, const std::string& unit) {
  std::string key = unit.empty() ? name : name + "_" + unit;
  for (char& letter : key) {
    if (letter == ' ' || letter == '/') letter = '_';
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return key;
}

// "rest length"
std::string WordsOf(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// What the twin was trained on: frames [0, train_frames) of each recording.
std::string DescribeTraining(const Twin& twin) {
  if (twin.trained_on.empty()) return "nothing";
  constexpr std::size_t kShown = 4;
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, twin.trained_on.size()); ++i) {
    text += fmt::format("{}{} (frames 0-{})", i > 0 ? ", " : "", twin.trained_on[i].name,
                        twin.trained_on[i].train_frames - 1);
  }
  if (twin.trained_on.size() > kShown) {
    text += fmt::format(" and {} more", twin.trained_on.size() - kShown);
  }
  return text;
}

// "drag_kg_per_m 0.01, wind_x_m_per_s 2, ..."
std::string DescribeValues(const EffectValues& effect) {
  std::string text;
  Eigen::Index i = 0;
  for (const EffectParameter& parameter : GetEffect(effect.name).parameters()) {
    text += (text.empty() ? "" : ", ") + parameter.key;
    for (int n = 0; n < parameter.count; ++n) text += fmt::format(" {:.4g}", effect.values[i++]);
  }
  return text;
}

std::string DescribeLevel(const TwinLevel& level, std::size_t number) {
  const SpringMassSystem& system = level.system;
  const double stable = ComputeStabilityBound(system).timestep;
  std::string text = fmt::format(
      "\nlevel {}: {} nodes, {} springs, {:g} kg\n"
      "  sub-step of training {:.3g} s, stable below {:.3g} s{}\n"
      "  {:<14} {:>10} {:>10} {:>10}\n",
      number, system.node_count(), system.spring_count(), system.mass.sum(),
      1.0 / level.substeps_per_second, stable,
      system.dashpot_stages > 1 ? fmt::format("; dashpots in {} stages", system.dashpot_stages)
                                : "",
      "", "least", "median", "most");
  for (const LevelList& list : kLevelLists) {
    const Range range = RangeOf(list.In(system));
    text += fmt::format("  {:<14} {:>10.4g} {:>10.4g} {:>10.4g} {}\n", WordsOf(list.name),
                        range.least, range.median, range.most, list.unit);
  }
  const ContactCoefficients& contact = system.contact;
  text += fmt::format("  drag {:.4g} 1/s; contact: {}{}; ", system.drag,
                      DescribeCoefficients(contact.surface),
                      contact.surface.cone == FrictionCone::kElliptic ? "" : " (pyramidal cone)");
  text += contact.collision_distance > 0
              ? fmt::format("particles collide at {:.3g} m: {}\n", contact.collision_distance,
                            DescribeCoefficients(contact.object))
              : "particles do not collide\n";
  for (const EffectValues& effect : system.effects) {
    text += fmt::format("  effect {}: {}\n", effect.name, DescribeValues(effect));
  }
  return text;
}

Json ToJson(const TwinLevel& level, std::size_t number) {
  const SpringMassSystem& system = level.system;
  const double stable = ComputeStabilityBound(system).timestep;
  Json json = {{"level", number},
               {"nodes", system.node_count()},
               {"springs", system.spring_count()},
               {"total_mass_kg", system.mass.sum()},
               {"substeps_per_second", level.substeps_per_second},
               {"dashpot_stages", system.dashpot_stages},
               {"stable_timestep_s", std::isfinite(stable) ? Json(stable) : Json(nullptr)}};
  for (const LevelList& list : kLevelLists) {
    const Range range = RangeOf(list.In(system));
    json[KeyOf(list.name, list.unit)] = {
        {"min", range.least}, {"median", range.median}, {"max", range.most}};
  }
  Json contact;
  for (const LevelScalar& scalar : kLevelScalars) {
    const bool of_contact = scalar.role != NumberRole::kSprings;
    if (scalar.role == NumberRole::kObject) contact["cone"] = ConeName(system.contact.surface.cone);
    (of_contact ? contact : json)[KeyOf(scalar.name, scalar.unit)] = scalar.In(system);
  }
  json["contact"] = contact;
  json["effects"] = Json::parse(EffectsToJson(system.effects));
  return json;
}

std::string DescribeFit(const Twin& twin) {
  if (!twin.fit_errors)
    return "not known: not trained to its end, changed since, or of an older program";
  return DescribeFitErrors(*twin.fit_errors) + (twin.fit_errors->LeavesNoise()
                                                    ? "; what is left is noise"
                                                    : "; what is left is more than noise");
}

std::string RodInWords(const Rod& rod) {
  if (rod.empty()) return "";
  const int joints = RodJoints(rod);
  if (joints == 0) return ", a rod";
  return fmt::format(", a rod with {} {}", joints, joints == 1 ? "joint" : "joints");
}

}  // namespace

std::string DescribeScales(const Twin& twin) {
  const double mass = twin.levels[0].system.mass.sum();
  std::string text =
      twin.force_scale
          ? fmt::format("scale: {:.4g} kg, and stiffnesses with it, by the measured forces\n", mass)
          : fmt::format(
                "scale: {:.4g} kg as the recordings say; stiffnesses are in proportion to it "
                "(measured forces would tell)\n",
                mass);
  if (twin.clock_offset) {
    text += fmt::format("clocks: the controllers moved {:.1f} ms {} than their clock says\n",
                        1e3 * std::abs(*twin.clock_offset),
                        *twin.clock_offset < 0 ? "earlier" : "later");
  }
  return text;
}

std::string DescribeTwin(const Twin& twin) {
  std::string text = fmt::format(
      "object       {} points, {} interior particles, {} controllers{}\n"
      "trained on   {}\n"
      "track error  {}\n"
      "controllers  {}\n"
      "ground       {}\n"
      "seed         {}\n"
      "options      {}\n",
      twin.points, twin.interior, twin.levels[0].system.controllers, RodInWords(twin.rod),
      DescribeTraining(twin), DescribeFit(twin),
      twin.controller_velocity ? "dashpots feel their velocity"
                               : "dashpots take them as standing still (PhysTwin)",
      twin.ground.known ? DescribeGround(twin.ground.plane)
                        : "not said (a file of an older program)",
      twin.seed, twin.options_json);
  text += DescribeScales(twin);
  for (std::size_t i = 0; i < twin.levels.size(); ++i) {
    text += DescribeLevel(twin.levels[i], i);
    if (i == 0 && twin.material) text += DescribeMaterial(*twin.material);
  }
  return text;
}

Json TwinToJson(const Twin& twin) {
  Json trained_on = Json::array(), levels = Json::array();
  for (const TrainedOn& recording : twin.trained_on) {
    trained_on.push_back({{"name", recording.name},
                          {"hash", recording.hash},
                          {"train_frames", recording.train_frames}});
  }
  for (std::size_t i = 0; i < twin.levels.size(); ++i) levels.push_back(ToJson(twin.levels[i], i));
  Json ground = twin.ground.known ? Json(nullptr) : Json("unknown");
  if (twin.ground.plane)
    ground = std::vector<double>(twin.ground.plane->begin(), twin.ground.plane->end());
  return {{"kind", "twin"},
          {"name", twin.name},
          {"points", twin.points},
          {"interior", twin.interior},
          {"controllers", twin.levels[0].system.controllers},
          {"rod", !twin.rod.empty()},
          {"rod_joints", RodJoints(twin.rod)},
          {"fps", twin.fps},
          {"gravity_m_s2", std::vector<double>(twin.gravity.begin(), twin.gravity.end())},
          {"ground", ground},
          {"controller_velocity", twin.controller_velocity},
          {"trained_on", trained_on},
          {"fit_errors", twin.fit_errors ? FitErrorsToJson(*twin.fit_errors) : Json(nullptr)},
          {"seed", twin.seed},
          {"options", ParseJson(twin.options_json, "options")},
          {"clock_offset_s", twin.clock_offset ? Json(*twin.clock_offset) : Json(nullptr)},
          {"force_scale", twin.force_scale ? Json(*twin.force_scale) : Json(nullptr)},
          {"material", twin.material ? MaterialToJson(*twin.material) : Json(nullptr)},
          {"levels", levels}};
}

}  // namespace physpring
