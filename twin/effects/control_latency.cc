// SPDX-License-Identifier: Apache-2.0
// Controllers that move later than recorded (two clocks, or a robot that lags its commands). The
// delay is applied where the controllers' motion is read from the recording: recorded_input.h.
#include "twin/effects/effect.h"

namespace physpring {
namespace {

class ControlLatency : public Effect {
 public:
  std::string name() const override { return "control_latency"; }
  EffectPicture Picture(const Eigen::VectorXd&, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = "a delay of the hands";
    picture.amount = 0;
    picture.where = "at the hands";
    return picture;
  }
  std::vector<EffectParameter> parameters() const override { return {{"latency_s", 0, 2, 0.02}}; }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Constant(1, 0.01), Eigen::VectorXd::Constant(1, 0.1)};
  }
  bool delays() const override { return true; }
  EffectMjcf Mjcf(const Eigen::VectorXd&, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin, {}, {}, "move the controllers later by as much"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeControlLatency() { return std::make_unique<ControlLatency>(); }

}  // namespace physpring
