// SPDX-License-Identifier: Apache-2.0
// Drag of the air, quadratic in the velocity against a uniform wind w: a node of mass m_i in a body
// of mass M feels F_i = -C m_i / M |v_i - w| (v_i - w). The linear drag of the system is another.
#include <fmt/format.h>

#include "twin/effects/effect.h"

namespace physpring {
namespace {

class AirDragForce : public EffectForce {
 public:
  AirDragForce(const SpringMassSystem& system, const Eigen::VectorXd& values)
      : coefficient_(values[0]), wind_(values.tail<3>()), mass_(system.mass) {}

  void Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd>, Points* force) const override {
    const double total = mass_.sum();
    for (Eigen::Index i = 0; i < mass_.size(); ++i) {
      const Eigen::Vector3d u = instant.v.col(i) - wind_;
      force->col(i) -= coefficient_ * mass_[i] / total * u.norm() * u;
    }
  }

  void AddAdjoint(const Instant& instant, const Eigen::Ref<const Eigen::VectorXd>&,
                  const Points& force_bar, Eigen::Ref<Eigen::VectorXd>,
                  InstantGradient* gradient) const override {
    const double total = mass_.sum();
    double mean = 0;  // the mean derivative with respect to the shares m / M
    for (Eigen::Index i = 0; i < mass_.size(); ++i) {
      const Eigen::Vector3d u = instant.v.col(i) - wind_, f_bar = force_bar.col(i);
      const double speed = u.norm(), share = mass_[i] / total;
      // forward: f = -C share |u| u
      const double power = speed * u.dot(f_bar);
      gradient->values[0] -= share * power;
      const double share_bar = -coefficient_ * power;
      gradient->parameters->mass[i] += share_bar / total;
      mean += share * share_bar;
      if (speed == 0) continue;
      const Eigen::Vector3d u_bar =
          -coefficient_ * share * (speed * f_bar + u.dot(f_bar) / speed * u);
      gradient->v.col(i) += u_bar;
      gradient->values.tail<3>() -= u_bar;
    }
    gradient->parameters->mass.array() -= mean / total;
  }

 private:
  double coefficient_;    // C, kg/m
  Eigen::Vector3d wind_;  // w, m/s
  Eigen::VectorXd mass_;
};

class AirDrag : public Effect {
 public:
  std::string name() const override { return "air_drag"; }
  EffectPicture Picture(const Eigen::VectorXd& values, const Setting&) const override {
    constexpr double kCalm = 0.3;  // m/s
    EffectPicture picture;
    const Eigen::Vector3d wind = values.tail<3>();
    picture.lacks = "the drag of the air";
    if (wind.norm() < kCalm) return picture;
    picture.lacks += fmt::format(" and a wind of about {:.2g} m/s", wind.norm());
    picture.arrows = {{"wind", "m/s", wind}};
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"drag_kg_per_m", 0, 100, 1, 1, EffectParameter::Spacing::kLogarithmic},
            {"wind_x_m_per_s", -30, 30, 1},
            {"wind_y_m_per_s", -30, 30, 1},
            {"wind_z_m_per_s", -30, 30, 1}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem& system) const override {
    // a terminal velocity of 10 m/s; the air still, or a wind that pushes with a tenth of the
    // weight
    const double drag = 0.1 * system.mass.sum(), wind = 3;
    std::vector<Eigen::VectorXd> starts = {Eigen::Vector4d(drag, 0, 0, 0)};
    for (const double side : {-wind, wind}) {
      starts.emplace_back(Eigen::Vector4d(drag, side, 0, 0));
      starts.emplace_back(Eigen::Vector4d(drag, 0, side, 0));
    }
    return starts;
  }
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    return std::make_unique<AirDragForce>(system, values);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin,
            {},
            {},
            "MuJoCo's wind acts along each axis by itself and on the bodies' inertia boxes"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeAirDrag() { return std::make_unique<AirDrag>(); }

}  // namespace physpring
