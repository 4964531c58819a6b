// SPDX-License-Identifier: Apache-2.0
#include "plugin/springs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "twin/attribute_names.h"
#include "twin/error.h"
#include "twin/stability.h"

namespace physpring {
namespace {

// The part of the largest stable sub-step that is taken where the attribute is not given.
constexpr double kSafety = 0.5;

using Vector = Eigen::Vector3d;

Level ReadLevelWithSprings(const mjModel* model, int instance, const Attributes& attributes) {
  Level level = ReadLevel(model, instance, attributes);
  ReadSprings(attributes, &level);
  return level;
}

constexpr double kMostSubsteps = 1e6;  // in a step

double ReadSubstep(const SpringMassSystem& system, const Attributes& attributes) {
  const double stable = ComputeStabilityBound(system).timestep;
  const double substep = attributes.Number(kAttrSubstep, kSafety * stable);
  if (substep > 0 && substep <= stable) return substep;
  throw Error(
      fmt::format("{}: attribute 'substep' is {} s, expected more than 0 and at most {:.3g}, "
                  "the largest that is stable",
                  attributes.where(), substep, stable));
}

// Numbers of a state without internal variables.
int PlainStateSize(const LevelBodies& bodies) {
  return 3 * static_cast<int>(bodies.nodes.size() + bodies.controllers.size()) + 1;
}

// Between the particles only: MuJoCo finds the rest.
Environment Nothing() { return {Vector::Zero(), {}}; }

}  // namespace

SpringsModel::SpringsModel(const mjModel* model, int instance)
    : level(ReadLevelWithSprings(model, instance, Attributes(model, instance))),
      controller_velocity(Attributes(model, instance).Flag(kAttrControllerVelocity, true)),
      substep(ReadSubstep(level.system, Attributes(model, instance))),
      step(level.system, Nothing(), BestKernel<double>()) {}

const std::vector<const char*>& Springs::AttributeNames() {
  static const std::vector<const char*> names = WithLevelNumbers(
      {kAttrNodes, kAttrControllers, kAttrSprings, kAttrOrder, kAttrEffects, kAttrSubstep,
       kAttrControllerVelocity, kAttrCone},
      {NumberRole::kSprings, NumberRole::kSurface, NumberRole::kObject, NumberRole::kReach});
  return names;
}

Springs::Springs(const mjModel* model, int instance)
    : springs_(std::make_shared<SpringsModel>(model, instance)),
      surfaces_(model, instance, springs_->level),
      state_(springs_->step.state_size()),
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
  const int size = PlainStateSize(springs_->level.bodies) + springs_->internal_size();
  if (model->plugin_statenum[instance] == size) return;
  throw Error(fmt::format("{}: the model was compiled with {} numbers of state, expected {}", where,
                          model->plugin_statenum[instance], size));
}

int Springs::StateSize(const mjModel* model, int instance) {
  const int size = PlainStateSize(FindBodies(model, instance));
  if (!Attributes(model, instance).Has(kAttrEffects)) return size;
  try {
    return size + SpringsModel(model, instance).internal_size();
  } catch (const std::exception&) {
    return size;  // refused, with a message, when an instance is made
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
                              const double* plugin_state) {
  const double* before = plugin_state + 3 * nodes();
  const bool known = before[3 * ways_.size()] != 0;
  for (std::size_t c = 0; c < ways_.size(); ++c) {
    const int body = springs_->level.bodies.controllers[c];
    const Eigen::Map<const Vector> now(data->xpos + 3 * body);
    Way& way = ways_[c];
    way.impulse.setZero();
    way.is_mocap = model->body_mocapid[model->body_rootid[body]] >= 0;
    if (way.is_mocap) {
      way.from = known ? Vector(Eigen::Map<const Vector>(before + 3 * c)) : Vector(now);
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
  springs_->step.Advance(
      {node_step_.View(), time, elapsed, h, controller_velocity_, pairs, kNoGeoms}, state_, &next_,
      &impacts_, &buffers_, [&](NodeStates<double>* next) { surfaces_.Apply(state_, h, next); });
  for (std::size_t c = 0; c < ways_.size(); ++c) {
    ways_[c].impulse += h * Eigen::Map<const Vector>(buffers_.force[nodes() + c].f);
  }
  std::swap(state_, next_);
}

void Springs::Compute(const mjModel* model, mjData* data, int instance) {
  const EulerStep step(model);
  const double time = step.time();
  const double wanted = std::ceil(time / springs_->substep - 1e-9);
  const int substeps = static_cast<int>(std::clamp(wanted, 1.0, kMostSubsteps));
  const double h = time / substeps;
  node_step_.Set(springs_->level.system, h, step.gravity());

  const double* plugin_state = data->plugin_state + model->plugin_stateadr[instance];
  ReadNodes(step, data, plugin_state);
  ReadControllers(model, data, time, plugin_state);
  ReadInternal(plugin_state + 3 * (nodes() + ways_.size()) + 1);
  if (!IsFinite()) return;  // MuJoCo warns
  surfaces_.Collect(model, data, state_);
  const Contact<double>::Pairs pairs = springs_->step.contact().FindPairs(state_, time);
  for (int i = 0; i < substeps; ++i) Substep(data->time, i * h, h, pairs);
  WriteForces(model, step, substeps, data);
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
  double* lag = data->plugin_state + model->plugin_stateadr[instance];
  if (is_computed_) {
    std::copy(lag_.begin(), lag_.end(), lag);
  } else {  // passive forces are switched off
    std::fill(lag, lag + lag_.size(), 0);
  }
  double* before = lag + lag_.size();
  for (int body : springs_->level.bodies.controllers) {
    before = std::copy(data->xpos + 3 * body, data->xpos + 3 * body + 3, before);
  }
  *before = 1;
  const double* internal = Internal(state_, springs_->step.first_internal());
  if (is_computed_) std::copy(internal, internal + springs_->internal_size(), before + 1);
  is_computed_ = false;
}

}  // namespace physpring
