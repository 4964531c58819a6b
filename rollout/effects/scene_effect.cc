// SPDX-License-Identifier: Apache-2.0
#include "rollout/effects/scene_effect.h"

#include <fmt/format.h>

namespace physpring {
namespace {

std::string Component(const std::string& stem, int axis, const std::string& unit) {
  return fmt::format("{}_{}_{}", stem, "xyz"[axis], unit);
}

}  // namespace

std::vector<EffectKey> VectorKeys(const EffectKey& stem, const std::string& unit) {
  std::vector<EffectKey> keys(3, stem);
  for (int axis = 0; axis < 3; ++axis) keys[axis].name = Component(stem.name, axis, unit);
  return keys;
}

void EffectAmounts::SetVector(const std::string& stem, const std::string& unit,
                              const Eigen::Vector3d& value) {
  for (int axis = 0; axis < 3; ++axis) Set(Component(stem, axis, unit), value[axis]);
}

double EffectAmounts::At(const std::string& key, double otherwise) const {
  const auto found = values_.find(key);
  return found == values_.end() ? otherwise : found->second;
}

Eigen::Vector3d EffectAmounts::Vector(const std::string& stem, const std::string& unit,
                                      const Eigen::Vector3d& otherwise) const {
  Eigen::Vector3d value;
  for (int axis = 0; axis < 3; ++axis) {
    value[axis] = At(Component(stem, axis, unit), otherwise[axis]);
  }
  return value;
}

void AddToBodies(const SceneBody& body, const mjModel& model, mjData* data,
                 const std::function<Eigen::Vector3d(int)>& force_at) {
  const std::set<int>& carriers = body.Carriers();
  double total = 0;
  for (const int carrier : carriers) total += model.body_mass[carrier];
  for (const int carrier : carriers) {
    const double share = model.body_mass[carrier] / total;
    Eigen::Map<Eigen::Vector3d>(data->xfrc_applied + 6 * carrier) += share * force_at(carrier);
  }
}

int PlaceIn(const SceneBody& body, const EffectAmounts& amounts) {
  const Eigen::Vector3d end = body.reference().col(body.FreeEnd());
  return body.NearestTo(amounts.Vector("place", "m", end));
}

std::string SceneEffect::WhyNot(const std::string&, const EffectAmounts&, const SceneBody&) const {
  return "";
}

void SceneEffect::Edit(const EffectAmounts&, const SceneBody&, mjSpec*) const {}

bool SceneEffect::ChangeMasses(const EffectAmounts&, const SceneBody&, mjModel*) const {
  return false;
}

void SceneEffect::Change(const EffectAmounts&, const SceneBody&, mjModel*) const {}

void SceneEffect::Drive(const EffectAmounts&, const SceneBody&, double, mjModel*) const {}

void SceneEffect::AddForces(const EffectAmounts&, const SceneBody&, double, const mjModel&,
                            mjData*) const {}

double SceneEffect::Latency(const EffectAmounts&) const { return 0; }

EffectAmounts SceneEffect::Trial(const EffectTrial&) const { return {}; }

}  // namespace physpring
