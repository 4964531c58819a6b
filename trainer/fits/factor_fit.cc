// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/factor_fit.h"

#include <fmt/format.h>

#include "trainer/motion/observer.h"

namespace physpring {
namespace {

constexpr double kFirstDamping = 1e-2;  // the damping with which each gain begins

struct FactorFit {
  Eigen::VectorXd factors;
  int gain;           // an index of kObserverGains
  int iteration = 0;  // steps made with this gain
  double damping = kFirstDamping;

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(factors, gain, iteration, damping);
  }
};

}  // namespace

ChosenBody FitCommonFactors(const ChosenBody& start, const std::vector<Episode>& episodes,
                            const TrainOptions& options, const GainSchedule& schedule,
                            const Work& work) {
  ChosenBody model = start;
  const auto step = [&](FactorFit* fit) -> StepReport {
    model.factors = fit->factors;
    const LevenbergMarquardtState after =
        StepFactors(model, episodes, options, kObserverGains[fit->gain], fit->damping);
    fit->factors = after.x;
    fit->damping = after.damping;
    ++fit->iteration;
    const double of_gain = static_cast<double>(fit->iteration) / schedule.most_steps;
    StepReport report{
        false, (fit->gain - schedule.first_gain + of_gain) / (kLastGain + 1 - schedule.first_gain),
        fmt::format("{}, all fit frames: {:.3f} mm", model.body.Label(),
                    PointMillimetres(after.mean_square))};
    if (fit->iteration < schedule.most_steps && !after.converged) return report;
    fit->iteration = 0;
    fit->damping = kFirstDamping;
    report.done = ++fit->gain > kLastGain;
    return report;
  };
  model.factors = work.Follow(FactorFit{start.factors, schedule.first_gain}, step).factors;
  return model;
}

}  // namespace physpring
