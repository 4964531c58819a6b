// SPDX-License-Identifier: Apache-2.0
// An effect that MuJoCo simulates for a recording: its keys, and what it does to the scene, by
// MuJoCo's own means (tendons, flexes, bodies and options) or by forces from outside; none of a
// twin's effects is used. Each has a file of its own; twin/effects/list.h lists them.
//
// What depends on time begins at time 0, the recording's first frame.
#ifndef PHYSPRING_ROLLOUT_EFFECTS_SCENE_EFFECT_H_
#define PHYSPRING_ROLLOUT_EFFECTS_SCENE_EFFECT_H_

#include <mujoco/mujoco.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "rollout/effects/scene_body.h"

namespace physpring {

struct EffectKey {
  std::string name;  // "tether.stiffness_n_per_m"; in a SceneEffect without "tether."
  double low, high;  // bounds of the value
  bool amount;       // without it, or with 0, the effect is not there
  std::string what;  // what MuJoCo does, for people

  std::string effect() const { return name.substr(0, name.find('.')); }
};

// Three keys STEM_x_UNIT, STEM_y_UNIT, STEM_z_UNIT that are alike.
std::vector<EffectKey> VectorKeys(const EffectKey& stem, const std::string& unit);

// The values of one effect, by keys without the effect's name.
class EffectAmounts {
 public:
  void Set(const std::string& key, double value) { values_[key] = value; }
  void SetVector(const std::string& stem, const std::string& unit, const Eigen::Vector3d& value);

  double At(const std::string& key, double otherwise = 0) const;
  Eigen::Vector3d Vector(const std::string& stem, const std::string& unit,
                         const Eigen::Vector3d& otherwise = Eigen::Vector3d::Zero()) const;
  const std::map<std::string, double>& all() const { return values_; }

 private:
  std::map<std::string, double> values_;
};

// Adds share * force_at(body) to the forces on each body that carries particles, its share that of
// the mass.
void AddToBodies(const SceneBody& body, const mjModel& model, mjData* data,
                 const std::function<Eigen::Vector3d(int)>& force_at);

// The particle that the keys place_x_m, place_y_m, place_z_m name; by default the free end.
inline constexpr char kPlaceHelp[] = "where in the reference configuration; default: the free end";
int PlaceIn(const SceneBody& body, const EffectAmounts& amounts);

// What a study tries an effect on: about how large it must be, where, and along which direction.
struct EffectTrial {
  double size = 1;                                      // about 1
  int nodes = 1;                                        // of the body
  double mass = 0, drag = 0;                            // of the whole body, kg; in the air, kg/m
  Eigen::Vector3d node = Eigen::Vector3d::Zero();       // one of them, m
  Eigen::Vector3d sideways = Eigen::Vector3d::UnitX();  // a horizontal direction
  Eigen::Vector3d beside = Eigen::Vector3d::Zero();     // a point beside the body, m
};

class SceneEffect {
 public:
  virtual ~SceneEffect() = default;

  virtual std::string name() const = 0;
  virtual std::vector<EffectKey> keys() const = 0;

  // Why a body cannot have it by this key; empty if it can.
  virtual std::string WhyNot(const std::string& key, const EffectAmounts& amounts,
                             const SceneBody& body) const;

  // Before the scene is compiled.
  virtual void Edit(const EffectAmounts& amounts, const SceneBody& body, mjSpec* spec) const;

  // After it, first of all: masses. Whether there is a change; MuJoCo's constants follow it.
  virtual bool ChangeMasses(const EffectAmounts& amounts, const SceneBody& body,
                            mjModel* model) const;
  // Then options, friction, rest lengths.
  virtual void Change(const EffectAmounts& amounts, const SceneBody& body, mjModel* model) const;

  // Before the step that begins at `time` >= 0 [s].
  virtual void Drive(const EffectAmounts& amounts, const SceneBody& body, double time,
                     mjModel* model) const;
  // Adds to the forces on bodies, data->xfrc_applied.
  virtual void AddForces(const EffectAmounts& amounts, const SceneBody& body, double time,
                         const mjModel& model, mjData* data) const;

  // How much later than recorded the mocap bodies move, s.
  virtual double Latency(const EffectAmounts& amounts) const;

  // Values with which a study tries it; none if it does not.
  virtual EffectAmounts Trial(const EffectTrial& trial) const;
};

}  // namespace physpring

#endif  // PHYSPRING_ROLLOUT_EFFECTS_SCENE_EFFECT_H_
