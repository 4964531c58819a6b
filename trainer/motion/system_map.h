// SPDX-License-Identifier: Apache-2.0
// The map from an unconstrained vector to a spring-mass system, whatever model it comes from.
#ifndef PHYSPRING_TRAINER_MOTION_SYSTEM_MAP_H_
#define PHYSPRING_TRAINER_MOTION_SYSTEM_MAP_H_

#include <functional>
#include <memory>
#include <utility>

#include "twin/simulator.h"
#include "twin/spring_mass_system.h"

namespace physpring {

class SystemMap {
 public:
  // `model` has the members Apply and Adjoint of parameters.h; a copy of it is kept.
  template <class Model>
  SystemMap(const Model& model)  // NOLINT(google-explicit-constructor): any model is a map
      : SystemMap(std::make_shared<const Model>(model)) {}

  // A map that has no adjoint: MotionProblem gives residuals alone.
  static SystemMap OfResiduals(std::function<SpringMassSystem(const Eigen::VectorXd&)> apply) {
    SystemMap map;
    map.apply_ = std::move(apply);
    return map;
  }

  SpringMassSystem Apply(const Eigen::VectorXd& x) const { return apply_(x); }

  // d loss / d x, from the derivatives with respect to the system Apply(x).
  Eigen::VectorXd Adjoint(const Eigen::VectorXd& x, const SpringMassSystem& system,
                          const SystemGradient& gradient) const {
    return adjoint_(x, system, gradient);
  }

 private:
  SystemMap() = default;
  template <class Model>
  explicit SystemMap(const std::shared_ptr<const Model>& model)
      : apply_([model](const Eigen::VectorXd& x) { return model->Apply(x); }),
        adjoint_([model](const Eigen::VectorXd& x, const SpringMassSystem& system,
                         const SystemGradient& gradient) {
          return model->Adjoint(x, system, gradient);
        }) {}

  std::function<SpringMassSystem(const Eigen::VectorXd&)> apply_;
  std::function<Eigen::VectorXd(const Eigen::VectorXd&, const SpringMassSystem&,
                                const SystemGradient&)>
      adjoint_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_MOTION_SYSTEM_MAP_H_
