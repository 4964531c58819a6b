// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/clock_fit.h"

#include <algorithm>
#include <vector>

#include "trainer/bodies/spring_net.h"
#include "trainer/data/held_back.h"
#include "trainer/fits/body_choice.h"
#include "trainer/fits/smooth_fit.h"

namespace physpring {
namespace {

constexpr int kMostRecordings = 4;
constexpr double kMostRate = 5000;  // sub-steps a second, at most

// A net whose last effect, the latency of its controllers, is fitted.
class NetOfLateHands : public BodyKind {
 public:
  std::string Addition() const override { return ", offset of clocks"; }
  bool has_single_springs() const override { return true; }
  void Free(const SpringMassSystem& /*base*/, ParameterOptions* options) const override {
    options->free_effects = 1;
  }
  int SearchedEffect(const Parameters& /*factors*/) const override { return -1; }
  LevenbergMarquardtOptions FactorOptions(const Recording& recording) const override {
    return SpringNet().FactorOptions(recording);
  }
  double handicap() const override { return 1; }
};

// The chosen body with hands that may be late; what it was fitted to stays.
ChosenBody WithLateHands(const ChosenBody& chosen, const Recording& recording) {
  static const NetOfLateHands kLateHands;
  ChosenBody late = chosen;
  late.body.kind = &kLateHands;
  late.body.effects.push_back({"control_latency", Eigen::VectorXd::Zero(1)});
  const Parameters factors = late.ParametersOf(recording);
  late.factors = Eigen::VectorXd::Zero(factors.size());
  late.factors.head(factors.effects()) = chosen.factors.head(factors.effects());
  late.start = late.factors;
  return late;
}

}  // namespace

double FitClockOffset(const FitData& data, const TrainOptions& options, const Work& work) {
  const Recording& first = data.recordings[0];
  const std::vector<Episode> episodes = FitEpisodes(data, kMostRecordings);
  const ChosenBody chosen =
      WithLateHands(ChooseBody(data, options, work.Part("choosing the model", 0, 0.3)), first);
  const SmoothlyFitted start =
      SoftSmoothBody(chosen, episodes, {std::min(kMostRate, MostRate(options, first))});
  const SmoothlyFitted rough = FitRoughly(start, GuidingGains(), chosen, episodes, options,
                                          work.Part("offset of clocks, roughly", 0.3, 0.6));
  const SmoothlyFitted fitted = FitToTheEnd(rough, chosen, episodes, options,
                                            work.Part("offset of clocks, to the end", 0.6, 1));
  return fitted.System().effects.back().values[0];
}

}  // namespace physpring
