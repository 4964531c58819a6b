// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/frame_walk.h"

#include "twin/environment.h"
#include "twin/recorded_input.h"

namespace physpring {
namespace {

template <class Real>
class FrameWalkIn : public FrameWalk {
 public:
  FrameWalkIn(const SpringMassSystem& system, const Recording& recording,
              const RolloutOptions& options, const LossOptions& loss)
      : recording_(recording),
        loss_(loss),
        simulator_(system, EnvironmentOf(recording),
                   {1 / recording.fps, options.substeps, options.controller_velocity,
                    LateGraspsOf(recording)}),
        workspace_(simulator_),
        state_(simulator_.MakeState(recording.start.leftCols(system.node_count()),
                                    recording.velocity)) {}

  std::optional<double> Step(const SpringMassSystem& system, SystemGradient* gradient) override {
    simulator_.SetParameters(system);
    const FrameInput input = RecordedInput(recording_, frame_ + 1, ControllerDelay(system));
    simulator_.RecordFrame(input, &state_, &workspace_);
    ++frame_;
    const Points position = simulator_.Positions(state_);
    if (!position.allFinite() || position.cwiseAbs().maxCoeff() > kFarAway) return {};

    Points position_bar = Points::Zero(3, position.cols());
    const double loss = AddFrameLoss(position, recording_, frame_, loss_, &position_bar);
    NodeStates<Real> state_bar(state_.size());
    for (int i = 0; i < position.cols(); ++i) {
      for (int j = 0; j < 3; ++j) state_bar[i].x[j] = static_cast<Real>(position_bar(j, i));
    }
    simulator_.RecordedFrameAdjoint(&state_bar, gradient, &workspace_);
    return loss;
  }

 private:
  const Recording& recording_;
  LossOptions loss_;
  Simulator<Real> simulator_;
  typename Simulator<Real>::Workspace workspace_;
  NodeStates<Real> state_;
  int frame_ = 0;
};

}  // namespace

std::unique_ptr<FrameWalk> StartWalk(const SpringMassSystem& system, const Recording& recording,
                                     const RolloutOptions& options, const LossOptions& loss) {
  if (options.single_precision) {
    return std::make_unique<FrameWalkIn<float>>(system, recording, options, loss);
  }
  return std::make_unique<FrameWalkIn<double>>(system, recording, options, loss);
}

}  // namespace physpring
