// SPDX-License-Identifier: Apache-2.0
#include "twin/predict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "twin/environment.h"
#include "twin/error.h"
#include "twin/hierarchy.h"
#include "twin/recorded_input.h"
#include "twin/simulator.h"
#include "twin/stability.h"

namespace physpring {
namespace {

void ExpectEqual(const Twin& twin, const Recording& recording, const char* what, int recorded,
                 int learned) {
  if (recorded == learned) return;
  throw Error(fmt::format(
      "recording {}: has {} {}, but twin {} has {}; a twin predicts recordings of its own object",
      recording.name, recorded, what, twin.name, learned));
}

template <class Real>
std::vector<Points> Simulate(const Twin& twin, int level, const Recording& recording,
                             int substeps) {
  const SimulationOptions options{1 / recording.fps, substeps, twin.controller_velocity,
                                  LateGraspsOf(recording)};
  const Simulator<Real> simulator(twin.levels[level].system, EnvironmentOf(recording), options);
  typename Simulator<Real>::Workspace workspace(simulator);
  const double delay = ControllerDelay(twin.levels[level].system);
  const Points start = recording.start.leftCols(recording.particle_count());
  auto state = simulator.MakeState(AverageOverMembers(twin, level, start),
                                   AverageOverMembers(twin, level, recording.velocity));
  std::vector<Points> positions{simulator.Positions(state)};
  for (int frame = 1; frame < recording.frame_count(); ++frame) {
    FrameInput input = RecordedInput(recording, frame, delay);
    Attachment& attached = input.attached;
    if (attached.any()) attached.nodes = AverageOverMembers(twin, level, attached.nodes);
    simulator.AdvanceFrame(input, &state, &workspace);
    positions.push_back(simulator.Positions(state));
    if (!IsFarAway(positions.back()) && simulator.Velocities(state).allFinite()) continue;
    throw Error(fmt::format(
        "recording {}: level {} of twin {} diverges in frame {} with {} sub-steps a frame; "
        "more sub-steps are needed",
        recording.name, level, twin.name, frame, substeps));
  }
  return positions;
}

}  // namespace

int ChooseSubsteps(const TwinLevel& level, double fps, int requested) {
  if (requested > 0) return requested;
  const int stable = StableSubsteps(ComputeStabilityBound(level.system), 1 / fps, kStepSafety);
  const int trained = static_cast<int>(std::ceil(level.substeps_per_second / fps - 1e-9));
  return std::max(stable, trained);
}

void ExpectSameObject(const Twin& twin, const Recording& recording) {
  ExpectEqual(twin, recording, "points", recording.point_count(), twin.points);
  ExpectEqual(twin, recording, "interior particles", recording.interior_count(), twin.interior);
  ExpectEqual(twin, recording, "controllers", recording.controller_count(),
              LevelOf(twin, 0).system.controllers);
}

std::vector<Points> Predict(const Twin& twin, int level, const Recording& recording,
                            const PredictOptions& options) {
  ExpectSameObject(twin, recording);
  const int substeps = ChooseSubsteps(LevelOf(twin, level), recording.fps, options.substeps);
  return options.single_precision ? Simulate<float>(twin, level, recording, substeps)
                                  : Simulate<double>(twin, level, recording, substeps);
}

}  // namespace physpring
