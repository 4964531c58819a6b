// SPDX-License-Identifier: Apache-2.0
#include "plugin/springs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "twin/attribute_names.h"
#include "twin/dashpot_stages.h"
#include "twin/error.h"
#include "twin/stability.h"

namespace physpring {
namespace {

// The part of the largest stable sub-step that is taken where the attribute is not given.
constexpr double kSafety = 0.5;

using Vector = Eigen::Vector3d;

int ReadDashpotStages(const Attributes& attributes) {
  const double stages = attributes.Number(kAttrDashpotStages, 1);
  if (stages >= 1 && stages <= kMostDashpotStages && stages == std::floor(stages)) {
    return static_cast<int>(stages);
  }
  throw Error(fmt::format("{}: attribute '{}' is {}, expected a whole number from 1 to {}",
                          attributes.where(), kAttrDashpotStages, stages, kMostDashpotStages));
}

Level ReadLevelWithSprings(const mjModel* model, int instance, const Attributes& attributes) {
  Level level = ReadLevel(model, instance, attributes);
  ReadSprings(attributes, &level);
  level.system.dashpot_stages = ReadDashpotStages(attributes);
  return level;
}

constexpr double kMostSubsteps = 1e6;  // in a step

ControllerMask ReadReleased(const SpringMassSystem& system, const Attributes& attributes) {
  ControllerMask released(static_cast<std::size_t>(system.controllers), false);
  if (!attributes.Has(kAttrReleased)) return released;
  const Eigen::VectorXd flags = attributes.Each(kAttrReleased, system.controllers);
  for (std::size_t c = 0; c < released.size(); ++c) {
    const double flag = flags[static_cast<Eigen::Index>(c)];
    if (flag != 0 && flag != 1) {
      throw Error(
          fmt::format("{}: released[{}] is {}, expected 0 or 1", attributes.where(), c, flag));
    }
    released[c] = flag == 1;
  }
  return released;
}

double ReadSubstep(const SpringMassSystem& system, const Attributes& attributes) {
  const double stable = ComputeStabilityBound(system).timestep;
  const double substep = attributes.Number(kAttrSubstep, kSafety * stable);
  if (substep > 0 && substep <= stable) return substep;
  throw Error(
      fmt::format("{}: attribute 'substep' is {} s, expected more than 0 and at most {:.3g}, "
                  "the largest that is stable",
                  attributes.where(), substep, stable));
}

int PlainStateSize(const LevelBodies& bodies) {
  return PluginState::PlainSize(static_cast<int>(bodies.nodes.size()),
                                static_cast<int>(bodies.controllers.size()));
}

ControllerMask All(const SpringMassSystem& system) {
  return ControllerMask(static_cast<std::size_t>(system.controllers), true);
}

// Between the particles only: MuJoCo finds the rest.
Environment Nothing() { return {Vector::Zero(), {}}; }

}  // namespace

SpringsModel::SpringsModel(const mjModel* model, int instance)
    : level(ReadLevelWithSprings(model, instance, Attributes(model, instance))),
      controller_velocity(Attributes(model, instance).Flag(kAttrControllerVelocity, true)),
      released(ReadReleased(level.system, Attributes(model, instance))),
      substep(ReadSubstep(level.system, Attributes(model, instance))),
      step(level.system, Nothing(), BestKernel<double>()),
      grasps(level.system, All(level.system), step.springs(), step.state_size()) {}

const std::vector<const char*>& Springs::AttributeNames() {
  static const std::vector<const char*> names = WithLevelNumbers(
      {kAttrNodes, kAttrControllers, kAttrSprings, kAttrOrder, kAttrRod, kAttrEffects, kAttrSubstep,
       kAttrDashpotStages, kAttrControllerVelocity, kAttrReleased, kAttrCone},
      {NumberRole::kSprings, NumberRole::kSurface, NumberRole::kObject, NumberRole::kReach});
  return names;
}

Springs::Springs(const mjModel* model, int instance)
    : springs_(std::make_shared<SpringsModel>(model, instance)),
      surfaces_(model, instance, springs_->level),
      released_(springs_->level.bodies.controllers.size(), false),
      rest_length_(springs_->step.effects().changed().system.rest_length),
      state_(springs_->state_size()),
      next_(state_.size()),
      buffers_(springs_->step.springs()),
      ways_(springs_->level.bodies.controllers.size()),
      controller_velocity_(3, static_cast<Eigen::Index>(ways_.size())),
      lag_(3 * static_cast<std::size_t>(nodes())) {
  const std::string where = Attributes(model, instance).where();
  CheckOptions(model, springs_->level, where);
  if (model->opt.timestep > kMostSubsteps * springs_->substep) {
    throw Error(
        fmt::format("{}: attribute 'substep' is {} s, less than a millionth of the time "
                    "step of {} s",
                    where, springs_->substep, model->opt.timestep));
  }
  const int size =
      PlainStateSize(springs_->level.bodies) + surfaces_.state_size() + springs_->internal_size();
  CheckStateSize(model, instance, size, where);
}

int Springs::StateSize(const mjModel* model, int instance) {
  const LevelBodies bodies = FindBodies(model, instance);
  const int size = PlainStateSize(bodies) + MocapMotion(model).state_size();
  if (bodies.controllers.empty() && !Attributes(model, instance).Has(kAttrEffects)) return size;
  try {
    return size + SpringsModel(model, instance).internal_size();
  } catch (const std::exception&) {
    return size;  // refused, with a message, when an instance is made
  }
}

void Springs::Reset(int size, double* state) const {
  std::fill_n(state, size, 0);
  const PluginState parts(state, nodes(), static_cast<int>(ways_.size()));
  for (double* flags : {parts.released, parts.were_released}) {
    std::copy(springs_->released.begin(), springs_->released.end(), flags);
  }
}

void Springs::ReadNodes(const EulerStep& step, const mjData* data, const double* lag) {
  const Level& level = springs_->level;
  for (int i = 0; i < nodes(); ++i) {
    const double* x = data->xpos + 3 * level.bodies.nodes[i];
    std::copy(x, x + 3, state_[i].x);
    Eigen::Map<Vector>(state_[i].v) =
        step.Velocity(data, level.dofs[i], level.joints[i]) + Eigen::Map<const Vector>(lag + 3 * i);
  }
}

void Springs::ReadControllers(const mjModel* model, const mjData* data, double time,
                              const double* before) {
  for (std::size_t c = 0; c < ways_.size(); ++c) {
    const int body = springs_->level.bodies.controllers[c];
    const Eigen::Map<const Vector> now(data->xpos + 3 * body);
    Way& way = ways_[c];
    way.impulse.setZero();
    way.is_mocap = model->body_mocapid[model->body_rootid[body]] >= 0;
    if (way.is_mocap) {
      way.from = before != nullptr ? Vector(Eigen::Map<const Vector>(before + 3 * c)) : Vector(now);
      way.velocity = (now - way.from) / time;
    } else {
      double velocity[6];
      mj_objectVelocity(model, data, mjOBJ_XBODY, body, velocity, 0);
      way.from = now;
      way.velocity = Eigen::Map<const Vector>(velocity + 3);
    }
    controller_velocity_.col(static_cast<Eigen::Index>(c)) = way.velocity;
  }
}

void Springs::ReadInternal(const double* internal) {
  std::copy(internal, internal + springs_->internal_size(),
            Internal(&state_, springs_->step.first_internal()));
}

void Springs::TakeHold(const ControllerMask& attached) {
  Attachment taken{attached, Points(3, static_cast<Eigen::Index>(ways_.size())),
                   Points(3, nodes())};
  for (std::size_t c = 0; c < ways_.size(); ++c) {
    taken.controllers.col(static_cast<Eigen::Index>(c)) = ways_[c].from;
  }
  for (int i = 0; i < nodes(); ++i) taken.nodes.col(i) = Eigen::Map<const Vector>(state_[i].x);
  springs_->grasps.Attach(taken, &state_);
}

void Springs::ReadGrasps(const PluginState& plugin_state) {
  if (ways_.empty()) return;
  const SpringMassSystem& system = springs_->step.effects().changed().system;
  const GraspSprings<double>& grasps = springs_->grasps;
  ControllerMask released, attached;
  for (std::size_t c = 0; c < ways_.size(); ++c) {
    released.push_back(plugin_state.released[c] != 0);
    attached.push_back(!released[c] && plugin_state.were_released[c] != 0);
  }
  if (std::find(attached.begin(), attached.end(), true) != attached.end()) TakeHold(attached);
  grasps.CopyShifts(state_, &next_);
  Eigen::VectorXd rest_length = system.rest_length;
  grasps.AddShifts(state_, &rest_length);
  if (released == released_ && rest_length == rest_length_) return;
  released_ = std::move(released);
  rest_length_ = std::move(rest_length);
  own_step_ = springs_->step;
  grasps.Apply(released_, state_, &*own_step_);
}

bool Springs::IsFinite() const {
  double sum = 0;
  for (int i = 0; i < nodes(); ++i) {
    for (int j = 0; j < 3; ++j) sum += state_[i].x[j] * 0 + state_[i].v[j] * 0;
  }
  return sum == 0;
}

// As in the trainer, mocap controllers are where they will be at the end of the sub-step.
void Springs::PlaceControllers(double elapsed, double h) {
  for (std::size_t c = 0; c < ways_.size(); ++c) {
    NodeState<double>& controller = state_[nodes() + c];
    const Way& way = ways_[c];
    const double time = way.is_mocap ? elapsed + h : elapsed;
    Eigen::Map<Vector>(controller.x) = way.from + time * way.velocity;
    Eigen::Map<Vector>(controller.v) =
        springs_->controller_velocity ? way.velocity : Vector(Vector::Zero());
  }
}

void Springs::Substep(double time, double elapsed, double h, const Contact<double>::Pairs& pairs) {
  static const std::vector<Geom> kNoGeoms;  // MuJoCo finds their contacts
  PlaceControllers(elapsed, h);
  step().Advance({node_step_.View(), time, elapsed, h, controller_velocity_, pairs, kNoGeoms},
                 state_, &next_, &impacts_, &buffers_,
                 [&](NodeStates<double>* next) { surfaces_.Apply(state_, h, next); });
  for (std::size_t c = 0; c < ways_.size(); ++c) {
    ways_[c].impulse += h * Eigen::Map<const Vector>(buffers_.force[nodes() + c].f);
  }
  std::swap(state_, next_);
}

void Springs::Compute(const mjModel* model, mjData* data, int instance) {
  const EulerStep euler(model);
  const double time = euler.time();
  const double wanted = std::ceil(time / springs_->substep - 1e-9);
  const int substeps = static_cast<int>(std::clamp(wanted, 1.0, kMostSubsteps));
  const double h = time / substeps;
  node_step_.Set(springs_->level.system, h, euler.gravity());

  const PluginState plugin_state = StateOf(model, data, instance);
  ReadNodes(euler, data, plugin_state.lag);
  ReadControllers(model, data, time, *plugin_state.known != 0 ? plugin_state.controllers : nullptr);
  ReadInternal(plugin_state.internal);
  ReadGrasps(plugin_state);
  surfaces_.Forget();
  if (!IsFinite()) return;  // MuJoCo warns
  surfaces_.Collect(model, data, state_, plugin_state.poses);
  const Contact<double>::Pairs pairs = springs_->step.contact().FindPairs(state_, time);
  for (int i = 0; i < substeps; ++i) Substep(data->time, i * h, h, pairs);
  WriteForces(model, euler, substeps, data);
}

void Springs::WriteForces(const mjModel* model, const EulerStep& step, int substeps, mjData* data) {
  const Level& level = springs_->level;
  for (int i = 0; i < nodes(); ++i) {
    const Eigen::Map<const Vector> x(state_[i].x), v(state_[i].v);
    Vector mean = v;
    if (substeps > 1) {
      mean = (x - Eigen::Map<const Vector>(data->xpos + 3 * level.bodies.nodes[i])) / step.time();
    }
    Eigen::Map<Vector>(lag_.data() + 3 * i) = v - mean;
    step.AddForceTo(mean, level.dofs[i], level.joints[i], level.system.mass[i], data);
  }
  surfaces_.AddReactions(model, data, step.time());
  for (std::size_t c = 0; c < ways_.size(); ++c) {
    if (ways_[c].is_mocap) continue;
    const int body = level.bodies.controllers[c];
    const Vector force = ways_[c].impulse / step.time();
    mj_applyFT(model, data, force.data(), nullptr, data->xpos + 3 * body, body, data->qfrc_passive);
  }
  is_computed_ = true;
}

void Springs::Advance(const mjModel* model, mjData* data, int instance) {
  const PluginState plugin_state = StateOf(model, data, instance);
  if (is_computed_) {
    std::copy(lag_.begin(), lag_.end(), plugin_state.lag);
  } else {  // passive forces are switched off
    std::fill_n(plugin_state.lag, lag_.size(), 0);
  }
  double* place = plugin_state.controllers;
  for (int body : springs_->level.bodies.controllers) {
    place = std::copy_n(data->xpos + 3 * body, 3, place);
  }
  std::copy_n(plugin_state.released, ways_.size(), plugin_state.were_released);
  *plugin_state.known = 1;
  surfaces_.KeepPoses(data, plugin_state.poses);
  const double* internal = Internal(state_, springs_->step.first_internal());
  if (is_computed_) std::copy_n(internal, springs_->internal_size(), plugin_state.internal);
  is_computed_ = false;
}

}  // namespace physpring
