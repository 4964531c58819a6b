// SPDX-License-Identifier: Apache-2.0
#include "exporter/level_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "twin/effects/effect_set.h"
#include "twin/effects/registry.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/predict.h"
#include "twin/quote.h"
#include "twin/stability.h"

namespace physpring {
namespace {

constexpr double kPluginTimestep = 2e-3;            // s
constexpr double kMostTimesTheSubsteps = 4;         // of tendons, where nobody asked for them
constexpr double kSlideLimit = 1.2360679774997898;  // sqrt(5) - 1, see below

// Names that MuJoCo gives itself: its root body and its main default class.
bool IsReserved(const std::string& name) { return name == "world" || name == "main"; }

bool IsPlain(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) || letter == '_' || letter == '.' ||
         letter == '-';
}

std::string ChooseName(const Twin& twin, const ExportOptions& options) {
  if (!options.name.empty()) {
    if (!std::all_of(options.name.begin(), options.name.end(), IsPlain)) {
      throw Error(fmt::format("name {}: only letters, digits and \"_.-\" may be in a name",
                              Quote(options.name)));
    }
    if (IsReserved(options.name)) {
      throw Error(fmt::format("name {}: is one that MuJoCo gives itself; choose another",
                              Quote(options.name)));
    }
    return options.name;
  }
  std::string name = twin.name.empty() || IsReserved(twin.name) ? "twin" : twin.name;
  std::replace_if(
      name.begin(), name.end(), [](char letter) { return !IsPlain(letter); }, '_');
  return name;
}

// The level as MuJoCo's own springs step it: they know no stages of dashpots.
TwinLevel WithoutStages(TwinLevel level) {
  level.system.dashpot_stages = 1;
  return level;
}

// How many times as many sub-steps tendons need.
double TimesTheSubsteps(const TwinLevel& level, double fps) {
  return static_cast<double>(ChooseSubsteps(WithoutStages(level), fps, 0)) /
         ChooseSubsteps(level, fps, 0);
}

SpringKind ChooseSprings(const Twin& twin, const TwinLevel& level, SpringKind asked) {
  if (asked != SpringKind::kAuto) return asked;
  const SpringMassSystem& system = level.system;
  if (!twin.late.empty() && system.controllers > 0) return SpringKind::kPlugin;
  const bool left_out = std::any_of(
      system.effects.begin(), system.effects.end(), [&system](const EffectValues& values) {
        return GetEffect(values.name).Mjcf(values.values, system).carrier ==
               EffectMjcf::Carrier::kPlugin;
      });
  const bool dear =
      system.dashpot_stages > 1 && TimesTheSubsteps(level, twin.fps) > kMostTimesTheSubsteps;
  return left_out || dear ? SpringKind::kPlugin : SpringKind::kTendon;
}

ControllerKind ChooseControllers(const Twin& twin, SpringKind springs, ControllerKind asked) {
  if (asked != ControllerKind::kAuto) return asked;
  // the plugin takes differences of a mocap body's places
  const bool needs_velocity = twin.controller_velocity && springs != SpringKind::kPlugin;
  return needs_velocity ? ControllerKind::kSlide : ControllerKind::kMocap;
}

ContactKind ChooseContact(SpringKind springs, ContactKind asked) {
  if (asked != ContactKind::kAuto) return asked;
  return springs == SpringKind::kPlugin ? ContactKind::kPlugin : ContactKind::kMujoco;
}

void ChooseTimesteps(const ExportOptions& options, LevelPlan* plan) {
  const TwinLevel& trained = plan->twin->levels[plan->level];
  const TwinLevel level = plan->springs == SpringKind::kPlugin ? trained : WithoutStages(trained);
  plan->critical_timestep = ComputeStabilityBound(level.system).timestep;
  plan->substep = 1 / (plan->twin->fps * ChooseSubsteps(level, plan->twin->fps, 0));
  plan->largest_timestep = std::numeric_limits<double>::infinity();
  if (plan->springs == SpringKind::kPlugin) {
    plan->timestep = options.timestep > 0 ? options.timestep : kPluginTimestep;
    plan->substep = std::min(plan->substep, plan->timestep);
  } else {
    if (options.timestep > 0) plan->substep = options.timestep;
    plan->timestep = plan->substep;
    plan->largest_timestep = plan->critical_timestep;
  }
  if (plan->timestep >= plan->largest_timestep) {
    throw Error(fmt::format(
        "twin {} level {}: a time step of {} s is unstable, expected less than {:.6g} s",
        Quote(plan->twin->name), plan->level, plan->timestep, plan->largest_timestep));
  }
  // kp = m / H^2 and kv = m / H of the controllers' actuators are stable below (sqrt(5) - 1) H:
  // r^2 + 2 r < 4 with r = h / H
  const bool slides = plan->controllers == ControllerKind::kSlide && plan->system().controllers > 0;
  if (slides) {
    plan->largest_timestep = std::min(plan->largest_timestep, kSlideLimit * plan->timestep);
  }
}

// What stands for an effect in MuJoCo.
EffectMjcf CarrierOf(const EffectValues& values, const LevelPlan& plan) {
  EffectMjcf mjcf = GetEffect(values.name).Mjcf(values.values, plan.system());
  if (mjcf.carrier == EffectMjcf::Carrier::kTendon && plan.springs != SpringKind::kTendon) {
    mjcf = {EffectMjcf::Carrier::kPlugin, {}, {}, "only tendons carry it"};
  }
  return mjcf;
}

// Forces of effects are the plugin's if the springs are; else MuJoCo's own features carry what
// they can.
void PlanEffects(LevelPlan* plan) {
  const SpringMassSystem& trained = plan->twin->levels[plan->level].system;
  plan->setting = ApplyEffects(trained, plan->twin->gravity);
  for (const EffectValues& values : trained.effects) {
    const bool has_forces = GetEffect(values.name).HasForces(plan->system(), values.values);
    if (has_forces && plan->springs == SpringKind::kPlugin) {
      plan->plugin_effects.push_back(values);
      continue;
    }
    EffectMjcf mjcf = CarrierOf(values, *plan);
    const bool missing = mjcf.carrier == EffectMjcf::Carrier::kPlugin;
    if (missing || !mjcf.difference.empty()) {
      plan->differences.push_back(fmt::format("effect {} is {}: {}", values.name,
                                              missing ? "left out" : "approximate",
                                              mjcf.difference));
    }
    plan->effects.push_back(std::move(mjcf));
  }
}

}  // namespace

std::string LevelPlan::LargestTimestep() const {
  return std::isfinite(largest_timestep) ? fmt::format("{:.4g} ms", 1e3 * largest_timestep) : "any";
}

std::string LevelPlan::Body(int column) const {
  const int nodes = system().node_count();
  if (column < nodes) return fmt::format("{}_{}", name, column);
  return fmt::format("{}_controller_{}", name, column - nodes);
}

std::string LevelPlan::Vertex(int node) const { return fmt::format("{}_vertex_{}", name, node); }

LevelPlan PlanLevel(const Twin& twin, int level, const ExportOptions& options) {
  LevelOf(twin, level);
  LevelPlan plan;
  plan.twin = &twin;
  plan.level = level;
  plan.name = ChooseName(twin, options);
  plan.springs = ChooseSprings(twin, twin.levels[level], options.springs);
  plan.controllers = ChooseControllers(twin, plan.springs, options.controllers);
  plan.contact = ChooseContact(plan.springs, options.contact);
  plan.flexes = options.flexes;
  PlanEffects(&plan);
  if (!twin.late.empty() && plan.system().controllers > 0 && plan.springs != SpringKind::kPlugin) {
    plan.differences.emplace_back(
        "grasps that begin late hold from the start: only the plugin opens "
        "them");
  }
  ChooseTimesteps(options, &plan);
  return plan;
}

}  // namespace physpring
