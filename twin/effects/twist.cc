// SPDX-License-Identifier: Apache-2.0
// Twist of a rod. A rod's twist spreads along it much faster than it bends, so that it is the same
// all along a section (twist_section.h): the angle by which the section's ends are turned against
// each other, over its length L. The angle, an internal variable that starts at 0, and the turn at
// the start, of sections that a hand holds, give the torque T = GJ (turn + angle) / L. Nodes feel
// the forces -T d angle / d x: torques on a straight rod are none, a bent one leaves its plane, and
// a joint rolls. A section with a hand that holds nothing has no torque, and goes on from there.
#include <algorithm>

#include "twin/effects/bend_effect.h"
#include "twin/effects/twist_section.h"

namespace physpring {
namespace {

class TwistForce : public EffectForce {
 public:
  TwistForce(const Eigen::VectorXd& values, std::vector<TwistSection> sections)
      : values_(values), sections_(std::move(sections)) {}

  int internal_size() const override { return static_cast<int>(sections_.size()); }

  void Add(const Instant& instant, Eigen::Ref<Eigen::VectorXd> internal,
           Points* force) const override {
    for (int s = 0; s < internal_size(); ++s) {
      if (IsReleased(s, instant)) {
        internal[s] = -Turn(s);
        continue;
      }
      const Points slope = sections_[s].Slope(instant.x);
      internal[s] += instant.step * slope.cwiseProduct(instant.v).sum();
      *force -= Torque(s, internal[s]) * slope;
    }
  }

  void AddAdjoint(const Instant& instant, const Eigen::Ref<const Eigen::VectorXd>& internal,
                  const Points& force_bar, Eigen::Ref<Eigen::VectorXd> internal_bar,
                  InstantGradient* gradient) const override {
    for (int s = 0; s < internal_size(); ++s) {
      const TwistSection& section = sections_[s];
      if (IsReleased(s, instant)) {
        if (section.is_held()) gradient->values[1] -= internal_bar[s];
        internal_bar[s] = 0;
        continue;
      }
      const Points slope = section.Slope(instant.x);
      const double angle = internal[s] + instant.step * slope.cwiseProduct(instant.v).sum();
      // forward: force = -torque slope
      const double torque_bar = -force_bar.cwiseProduct(slope).sum();
      // forward: torque = GJ (turn + angle) / L
      const double stiffness = values_[0] / section.length();
      gradient->values[0] += torque_bar * (Turn(s) + angle) / section.length();
      if (section.is_held()) gradient->values[1] += torque_bar * stiffness;
      internal_bar[s] += torque_bar * stiffness;
      // forward: angle += h slope . v
      const double rate_bar = instant.step * internal_bar[s];
      gradient->v += rate_bar * slope;
      section.AddSlopeAdjoint(instant.x, rate_bar * instant.v - Torque(s, angle) * force_bar,
                              &gradient->x);
    }
  }

 private:
  // Whether one of its hands holds nothing: the twist leaves through that end.
  bool IsReleased(int section, const Instant& instant) const {
    const std::vector<int>& columns = sections_[section].columns();
    return std::any_of(columns.begin(), columns.end(),
                       [&](int column) { return instant.IsReleased(column); });
  }
  double Turn(int section) const { return sections_[section].is_held() ? values_[1] : 0; }
  double Torque(int section, double angle) const {
    return values_[0] * (Turn(section) + angle) / sections_[section].length();
  }

  const Eigen::VectorXd values_;
  const std::vector<TwistSection> sections_;
};

class TwistEffect : public Effect {
 public:
  std::string name() const override { return "twist"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a resistance to twist";
    picture.amount = 0;
    picture.where = "along the whole body";
    return picture;
  }
  bool bends() const override { return true; }
  bool MayBeMissing(const BodyTraits& body) const override {
    return body.twists && Effect::MayBeMissing(body);
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"torsional_rigidity_n_m2", 0, 1, 1, 1, EffectParameter::Spacing::kLogarithmic},
            {"turn_rad", -100, 100, 1}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    std::vector<Eigen::VectorXd> starts;
    for (double rigidity : {1e-4, 1e-3}) {
      for (double turn : {-2.0, 0.0, 2.0}) starts.emplace_back(Eigen::Vector2d(rigidity, turn));
    }
    return starts;
  }
  RodPart rod_part() const override { return RodPart::kFitted; }
  Eigen::VectorXd StartOfRod(const RodTraits& rod) const override {
    return rod.twists ? Eigen::VectorXd(Eigen::Vector2d(rod.flexural_rigidity, 0))
                      : Eigen::VectorXd();
  }
  // Nothing where no section of a rod is kept from rolling at both ends.
  std::unique_ptr<EffectForce> MakeForce(const SpringMassSystem& system,
                                         const Eigen::VectorXd& values) const override {
    std::vector<TwistSection> sections = FindTwistSections(system);
    if (sections.empty()) return nullptr;
    return std::make_unique<TwistForce>(values, std::move(sections));
  }
  void Stiffen(const Eigen::VectorXd& values, SpringMassSystem* bound) const override {
    if (HasTwistSections(bound->rod, bound->node_count())) StiffenLikeBending(values[0], 0, bound);
  }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "tendons do not twist"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeTwist() { return std::make_unique<TwistEffect>(); }

}  // namespace physpring
