// SPDX-License-Identifier: Apache-2.0
// Damping of bending: the moment at a triple of nodes is D kappa_dot / length. Drag also damps the
// motion of the whole, dashpots also that along the springs; this only changes of shape.
#include <cmath>

#include "twin/effects/bend_effect.h"

namespace physpring {
namespace {

constexpr double kCalm = 100;  // 1/s, of a rod with which a fit starts

class BendingDampingMoment : public BendMoment {
 public:
  using BendMoment::BendMoment;

  Vector Moment(int triple, const Bend& bend, double, Vector*) const override {
    return values_[0] / triples()[triple].length * bend.rate;
  }
  void MomentAdjoint(int triple, const Bend& bend, double, const Vector&, const Vector& moment_bar,
                     Vector*, Bend* bar, Eigen::VectorXd* values_bar) const override {
    const double length = triples()[triple].length;
    (*values_bar)[0] += moment_bar.dot(bend.rate) / length;
    bar->rate += values_[0] / length * moment_bar;
  }
};

class BendingDamping : public Effect {
 public:
  std::string name() const override { return "bending_damping"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a damping of bending";
    picture.amount = 0;
    picture.where = "wherever the body bends";
    return picture;
  }
  bool bends() const override { return true; }
  std::vector<EffectParameter> parameters() const override {
    return {{"damping_n_m2_s", 0, 1, 1, 1, EffectParameter::Spacing::kLogarithmic}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Constant(1, 1e-6)};
  }
  // A little, which calms the shortest waves; more would serve fits under an observer, but not free
  // motions. In an even chain of nodes of mass m at distances l those decay at 16 D / (m l^3).
  RodPart rod_part() const override { return RodPart::kGiven; }
  Eigen::VectorXd StartOfRod(const RodTraits& rod) const override {
    const double damping = kCalm * rod.node_mass * std::pow(rod.spacing, 3) / 16;
    return Eigen::VectorXd::Constant(1, damping);
  }
  std::unique_ptr<BendMoment> MakeBend(const SpringMassSystem& system,
                                       const Eigen::VectorXd& values) const override {
    return std::make_unique<BendingDampingMoment>(system, values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    StiffenLikeBending(0, values[0], bound);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "tendons do not bend"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeBendingDamping() { return std::make_unique<BendingDamping>(); }

}  // namespace physpring
