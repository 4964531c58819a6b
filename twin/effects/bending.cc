// SPDX-License-Identifier: Apache-2.0
// Stiffness against bending: the moment at a triple of nodes is B kappa / length, the one of an
// elastic rod of flexural rigidity B [N m^2] that is straight at rest. At a joint that is bent by
// kappa_0 at rest it is B (|kappa| - kappa_0) / length, in the direction of kappa: branches keep
// their angles.
#include "twin/effects/bend_effect.h"

namespace physpring {
namespace {

constexpr double kStraight = 1e-9;  // rad

class BendingMoment : public BendMoment {
 public:
  using BendMoment::BendMoment;

  Vector Moment(int triple, const Bend& bend, double, Vector*) const override {
    return values_[0] / triples()[triple].length * Beyond(triple, bend.bend);
  }
  void MomentAdjoint(int triple, const Bend& bend, double, const Vector&, const Vector& moment_bar,
                     Vector*, Bend* bar, Eigen::VectorXd* values_bar) const override {
    const double length = triples()[triple].length;
    (*values_bar)[0] += moment_bar.dot(Beyond(triple, bend.bend)) / length;
    const Vector beyond_bar = values_[0] / length * moment_bar;
    const double rest = triples()[triple].rest, size = bend.bend.norm();
    if (rest > 0 && size < kStraight) return;
    bar->bend += beyond_bar;
    if (rest == 0) return;
    // forward: beyond = kappa - rest kappa / |kappa|
    const Vector direction = bend.bend / size;
    bar->bend -= rest / size * (beyond_bar - direction.dot(beyond_bar) * direction);
  }

 private:
  // By how much it is bent more than at rest. A straight joint has no direction to go.
  Vector Beyond(int triple, const Vector& bend) const {
    const double rest = triples()[triple].rest, size = bend.norm();
    if (rest == 0) return bend;
    return size < kStraight ? Vector(Vector::Zero()) : Vector((1 - rest / size) * bend);
  }
};

class Bending : public Effect {
 public:
  std::string name() const override { return "bending"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a resistance to bending";
    picture.amount = 0;
    picture.where = "wherever the body bends";
    return picture;
  }
  bool bends() const override { return true; }
  std::vector<EffectParameter> parameters() const override {
    return {{"flexural_rigidity_n_m2", 0, 10, 1, 1, EffectParameter::Spacing::kLogarithmic}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Constant(1, 1e-5), Eigen::VectorXd::Constant(1, 1e-3)};
  }
  RodPart rod_part() const override { return RodPart::kFitted; }
  Eigen::VectorXd StartOfRod(const RodTraits& rod) const override {
    return Eigen::VectorXd::Constant(1, rod.flexural_rigidity);
  }
  double FlexuralRigidity(const Eigen::VectorXd& values) const override { return values[0]; }
  std::unique_ptr<BendMoment> MakeBend(const SpringMassSystem& system,
                                       const Eigen::VectorXd& values) const override {
    return std::make_unique<BendingMoment>(system, values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    StiffenLikeBending(values[0], 0, bound);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "tendons do not bend"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeBending() { return std::make_unique<Bending>(); }

}  // namespace physpring
