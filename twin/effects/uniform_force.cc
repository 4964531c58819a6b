// SPDX-License-Identifier: Apache-2.0
// A force on the whole body with a free course in time: each node gets the share m_i / M of F(t),
// which is piecewise linear between values every `interval` seconds, and constant after the last.
#include <algorithm>
#include <array>
#include <cmath>

#include "twin/effects/effect.h"

namespace physpring {
namespace {

constexpr int kForceKnots = 12;

class UniformForceForce : public EffectForce {
 public:
  UniformForceForce(const SpringMassSystem& system, const Eigen::VectorXd& values)
      : interval_(values[0]), course_(values.tail(3 * kForceKnots).reshaped(kForceKnots, 3)) {
    mass_ = system.mass;
  }

  void Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd>, Points* force) const override {
    const Course at = At(instant.time);
    force->leftCols(mass_.size()) += at.force * mass_.transpose() / mass_.sum();
  }

  void AddAdjoint(const Instant& instant, const Eigen::Ref<const Eigen::VectorXd>&,
                  const Points& force_bar, Eigen::Ref<Eigen::VectorXd>,
                  InstantGradient* gradient) const override {
    const Course at = At(instant.time);
    const double total = mass_.sum();
    const Eigen::VectorXd share_bar = force_bar.leftCols(mass_.size()).transpose() * at.force;
    gradient->parameters->mass +=
        (share_bar.array() - share_bar.dot(mass_) / total).matrix() / total;
    const Eigen::Vector3d bar = force_bar.leftCols(mass_.size()) * mass_ / total;
    auto course_bar = gradient->values.tail(3 * kForceKnots).reshaped(kForceKnots, 3);
    course_bar.row(at.knot) += (1 - at.fraction) * bar.transpose();
    course_bar.row(at.knot + 1) += at.fraction * bar.transpose();
    gradient->values[0] +=
        at.interval_slope * bar.dot((course_.row(at.knot + 1) - course_.row(at.knot)).transpose());
  }

 private:
  struct Course {
    Eigen::Vector3d force;
    int knot;
    double fraction, interval_slope;  // the part of the way to the next knot, and its derivative
  };
  Course At(double time) const {
    const double place = interval_ > 0 ? time / interval_ : 0;
    Course at;
    at.knot = std::min(static_cast<int>(place), kForceKnots - 2);
    at.fraction = std::min(1.0, place - at.knot);
    at.interval_slope = at.fraction < 1 && interval_ > 0 ? -place / interval_ : 0;
    at.force =
        (course_.row(at.knot) + at.fraction * (course_.row(at.knot + 1) - course_.row(at.knot)))
            .transpose();
    return at;
  }

  double interval_;         // s
  Eigen::MatrixXd course_;  // knots x 3, N
  Eigen::VectorXd mass_;
};

class UniformForce : public Effect {
 public:
  std::string name() const override { return "uniform_force"; }
  EffectPicture Picture(const Eigen::VectorXd& values, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a force on the whole body that changes with time";
    picture.courses = {{"force", 1, kForceKnots, values[0]}};
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"interval_s", 0, 100, 1, 1, EffectParameter::Spacing::kLogarithmic},
            {"force_x_n", -1e3, 1e3, 0.05, kForceKnots},
            {"force_y_n", -1e3, 1e3, 0.05, kForceKnots},
            {"force_z_n", -1e3, 1e3, 0.05, kForceKnots}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    Eigen::VectorXd start = Eigen::VectorXd::Zero(1 + 3 * kForceKnots);
    start[0] = 0.25;
    return {start};
  }
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    return std::make_unique<UniformForceForce>(system, values);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "a force with a course in time is an input"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeUniformForce() { return std::make_unique<UniformForce>(); }

}  // namespace physpring
