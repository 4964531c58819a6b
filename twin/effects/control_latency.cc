// SPDX-License-Identifier: Apache-2.0
// Controllers that move later than recorded (a robot that lags its commands), or earlier if the
// latency is negative (of two clocks either may be late). It is applied where the controllers'
// motion is read from the recording, which has all of it: recorded_input.h.
#include "twin/effects/effect.h"

namespace physpring {
namespace {

class ControlLatency : public Effect {
 public:
  std::string name() const override { return "control_latency"; }
  EffectPicture Picture(const Eigen::VectorXd& values, const Setting&) const override {
    EffectPicture picture;
    picture.lacks = values[0] < 0 ? "hands ahead of the recording" : "a delay of the hands";
    picture.amount = 0;
    picture.where = "at the hands";
    return picture;
  }
  std::vector<EffectParameter> parameters() const override {
    return {{"latency_s", -0.5, 2, 0.02}};
  }
  std::vector<Eigen::VectorXd> Starts(const SpringMassSystem&) const override {
    return {Eigen::VectorXd::Constant(1, 0.01), Eigen::VectorXd::Constant(1, 0.1),
            Eigen::VectorXd::Constant(1, -0.05)};
  }
  bool delays() const override { return true; }
  EffectMjcf Mjcf(const Eigen::VectorXd& values, const SpringMassSystem&) const override {
    return {EffectMjcf::Carrier::kPlugin,
            {},
            {},
            values[0] < 0
                ? "move the controllers earlier by as much; who does not know their motion "
                  "ahead cannot"
                : "move the controllers later by as much"};
  }
};

}  // namespace

std::unique_ptr<Effect> MakeControlLatency() { return std::make_unique<ControlLatency>(); }

}  // namespace physpring
