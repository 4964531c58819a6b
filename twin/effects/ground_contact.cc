// SPDX-License-Identifier: Apache-2.0
// Contact with ground and geoms other than declared: changes of friction and restitution, kept
// within their ranges.
#include <algorithm>
#include <cmath>

#include "twin/effects/effect.h"

namespace physpring {
namespace {

class GroundContact : public Effect {
 public:
  std::string name() const override { return "ground_contact"; }
  EffectPicture Picture(const Eigen::VectorXd& values, const Setting&) const override {
    EffectPicture picture;
    const bool friction = std::abs(values[0]) >= std::abs(values[1]);
    picture.lacks = friction ? "a change of the friction on the ground"
                             : "a change of how it bounces off the ground";
    picture.amount = friction ? 0 : 1;
    picture.where = "where the body touches the ground";
    return picture;
  }
  bool MayBeMissing(const BodyTraits& body) const override { return body.on_ground; }
  std::vector<EffectParameter> parameters() const override {
    return {{"friction_change", -2, 2, 0.2}, {"restitution_change", -1, 1, 0.2}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Zero(2), Eigen::Vector2d(0.5, 0), Eigen::Vector2d(-0.5, 0)};
  }

  void Change(const Eigen::VectorXd& values, Setting* setting) const override {
    ContactPair<double>& contact = setting->system.contact.surface;
    contact.friction = std::clamp(contact.friction + values[0], 0.0, 2.0);
    contact.restitution = std::clamp(contact.restitution + values[1], 0.0, 1.0);
  }

  void ChangeAdjoint(const Eigen::VectorXd& values, const Setting& before, SystemGradient* gradient,
                     Eigen::VectorXd* values_bar) const override {
    const ContactPair<double>& contact = before.system.contact.surface;
    ContactPair<double>& bar = gradient->contact.surface;
    // forward: y = clamp(x + value): nothing passes where it is clamped
    const double friction = contact.friction + values[0];
    const double restitution = contact.restitution + values[1];
    if (friction < 0 || friction > 2) bar.friction = 0;
    if (restitution < 0 || restitution > 1) bar.restitution = 0;
    (*values_bar)[0] += bar.friction;
    (*values_bar)[1] += bar.restitution;
  }

  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kSetting, {}, {}, ""};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeGroundContact() { return std::make_unique<GroundContact>(); }

}  // namespace physpring
