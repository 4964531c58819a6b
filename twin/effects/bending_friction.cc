// SPDX-License-Identifier: Apache-2.0
// Friction of bending, independent of the rate (strands of a cable that slide): at each triple of
// length l a moment m that gives way at the curvature c (Prandtl's element in two dimensions):
//   z <- z + h kappa_dot, shortened to |z| <= delta = c l,   M = m z / delta
#include "twin/effects/bend_effect.h"

namespace physpring {
namespace {

constexpr double kHeld = 0.3;  // part of the elastic moment where a rod begins to slip

class BendingFrictionMoment : public BendMoment {
 public:
  using BendMoment::BendMoment;

  bool has_internal() const override { return true; }

  Vector Moment(int triple, const Bend& bend, double step, Vector* z) const override {
    const double slip = Slip(triple);
    if (slip == 0) return Vector::Zero();
    *z += step * bend.rate;
    if (z->norm() > slip) *z *= slip / z->norm();
    return values_[0] / slip * *z;
  }

  void MomentAdjoint(int triple, const Bend& bend, double step, const Vector& z,
                     const Vector& moment_bar, Vector* z_bar, Bend* bar,
                     Eigen::VectorXd* values_bar) const override {
    const double slip = Slip(triple);
    if (slip == 0) return;
    const Vector free = z + step * bend.rate;
    const double length = free.norm();
    const bool slips = length > slip;
    const Vector after = slips ? Vector(slip / length * free) : free;
    // forward: M = m z / delta
    const double along = moment_bar.dot(after) / slip;
    (*values_bar)[0] += along;
    double slip_bar = -values_[0] * along / slip;
    *z_bar += values_[0] / slip * moment_bar;
    if (slips) {
      // forward: z' = delta z / |z|
      const Vector direction = free / length;
      slip_bar += direction.dot(*z_bar);
      *z_bar = slip / length * (*z_bar - direction.dot(*z_bar) * direction);
    }
    (*values_bar)[1] += slip_bar * triples()[static_cast<std::size_t>(triple)].length;
    bar->rate += step * *z_bar;
  }

 private:
  // delta, rad.
  double Slip(int triple) const {
    return values_[1] * triples()[static_cast<std::size_t>(triple)].length;
  }
};

class BendingFriction : public Effect {
 public:
  std::string name() const override { return "bending_friction"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a friction in bending";
    picture.amount = 0;
    picture.where = "wherever the body bends";
    return picture;
  }
  bool bends() const override { return true; }
  std::vector<EffectParameter> parameters() const override {
    return {{"moment_n_m", 0, 10, 1, 1, EffectParameter::Spacing::kLogarithmic},
            {"slip_curvature_per_m", 0, 1000, 1, 1, EffectParameter::Spacing::kLogarithmic}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::Vector2d(1e-4, 1), Eigen::Vector2d(1e-3, 4)};
  }
  RodPart rod_part() const override { return RodPart::kFitted; }
  Eigen::VectorXd StartOfRod(const RodTraits& rod) const override {
    const double moment = kHeld * rod.flexural_rigidity * rod.slip_angle / rod.length;
    return Eigen::Vector2d(moment, rod.slip_angle / rod.length);
  }
  std::unique_ptr<BendMoment> MakeBend(const SpringMassSystem& system,
                                       const Eigen::VectorXd& values) const override {
    return std::make_unique<BendingFrictionMoment>(system, values);
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    if (values.isZero() || values[1] == 0) return;
    StiffenLikeBending(values[0] / values[1], 0, bound);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "tendons do not bend"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeBendingFriction() { return std::make_unique<BendingFriction>(); }

}  // namespace physpring
