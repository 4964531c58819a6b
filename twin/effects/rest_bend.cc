// SPDX-License-Identifier: Apache-2.0
// A body that is bent at rest: at each triple a moment that bends it upwards and sideways, which
// vary along the body, piecewise linear between knots; the ends are the directions of the grasps.
// The moment is what counts, not an angle: the springs themselves resist bending, too.
//   side = up x s / |up x s|,   M = -(m_up (s x side) + m_side side),   s the tangent
// The frame is taken from the vertical, so the body must not roll about its own axis, and where it
// is vertical there is no moment.
#include <Eigen/Geometry>

#include "twin/effects/bend_effect.h"
#include "twin/effects/body_coordinate.h"

namespace physpring {
namespace {

constexpr int kBendKnots = 8;
constexpr double kVertical = 1e-6;  // sine of the angle between tangent and the vertical

class RestBendMoment : public BendMoment {
 public:
  RestBendMoment(const SpringMassSystem& system, const Eigen::VectorXd& values)
      : BendMoment(system, values) {
    const Eigen::VectorXd along = BodyCoordinate(system);
    Eigen::VectorXd at(static_cast<Eigen::Index>(triples().size()));
    for (Eigen::Index i = 0; i < at.size(); ++i) {
      at[i] = along[triples()[static_cast<std::size_t>(i)].b];
    }
    knots_ = KnotWeights(at, kBendKnots);
    moments_ = knots_ * values.reshaped(kBendKnots, 2);
  }

  Vector Moment(int triple, const Bend& bend, double, Vector*) const override {
    const Vector across = Vector::UnitZ().cross(bend.tangent);
    if (across.norm() < kVertical) return Vector::Zero();
    const Vector side = across.normalized();
    return -moments_(triple, 0) * bend.tangent.cross(side) - moments_(triple, 1) * side;
  }

  void MomentAdjoint(int triple, const Bend& bend, double, const Vector&, const Vector& moment_bar,
                     Vector*, Bend* bar, Eigen::VectorXd* values_bar) const override {
    const Vector& s = bend.tangent;
    const Vector across = Vector::UnitZ().cross(s);
    if (across.norm() < kVertical) return;
    const Vector side = across.normalized();
    const double m_up = moments_(triple, 0), m_side = moments_(triple, 1);
    values_bar->reshaped(kBendKnots, 2).noalias() -=
        knots_.row(triple).transpose() *
        Eigen::RowVector2d(moment_bar.dot(s.cross(side)), moment_bar.dot(side));
    const Vector side_bar = -m_side * moment_bar - m_up * moment_bar.cross(s);
    bar->tangent -= m_up * side.cross(moment_bar);
    // forward: side = across / |across|, across = up x s
    const Vector across_bar = (side_bar - side.dot(side_bar) * side) / across.norm();
    bar->tangent += across_bar.cross(Vector::UnitZ());
  }

 private:
  Eigen::MatrixXd knots_;    // triples x knots
  Eigen::MatrixXd moments_;  // triples x (up, side), N m
};

class RestBend : public Effect {
 public:
  std::string name() const override { return "rest_bend"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a shape at rest that is bent";
    picture.profiles = {{"moment upwards", 0, kBendKnots},
                        {"moment sideways", kBendKnots, kBendKnots}};
    return picture;
  }
  bool bends() const override { return true; }
  std::vector<EffectParameter> parameters() const override {
    using Spacing = EffectParameter::Spacing;
    return {{"moment_up_n_m", -10, 10, 1e-3, kBendKnots, Spacing::kEven, true},
            {"moment_side_n_m", -10, 10, 1e-3, kBendKnots, Spacing::kEven, true}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Zero(2 * kBendKnots)};
  }
  RodPart rod_part() const override { return RodPart::kFitted; }
  Eigen::VectorXd StartOfRod(const RodTraits&) const override {
    return Eigen::VectorXd::Zero(2 * kBendKnots);
  }
  std::unique_ptr<BendMoment> MakeBend(const SpringMassSystem& system,
                                       const Eigen::VectorXd& values) const override {
    return std::make_unique<RestBendMoment>(system, values);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "tendons do not bend"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeRestBend() { return std::make_unique<RestBend>(); }

}  // namespace physpring
