// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/fit_residual.h"

#include <algorithm>
#include <cmath>

#include "trainer/bodies/factors.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

// Residual forces as one vector, and back.
Eigen::VectorXd Pack(const ResidualForce& residual) {
  const Eigen::Index nodes = residual.noise.size(), each = 3 * nodes;
  const auto steps = static_cast<Eigen::Index>(residual.force.size());
  Eigen::VectorXd packed(1 + nodes + each * (2 * steps + 1));
  packed.head(1 + nodes) << residual.left, residual.noise;
  Eigen::Index at = 1 + nodes;
  for (const auto* series : {&residual.force, &residual.position}) {
    for (const Points& points : *series) {
      packed.segment(at, each) = points.reshaped();
      at += each;
    }
  }
  return packed;
}

ResidualForce Unpack(const Eigen::VectorXd& packed, int nodes) {
  ResidualForce residual;
  const Eigen::Index each = 3 * nodes, steps = ((packed.size() - 1 - nodes) / each - 1) / 2;
  residual.left = packed[0];
  residual.noise = packed.segment(1, nodes);
  Eigen::Index at = 1 + nodes;
  for (Eigen::Index n = 0; n < 2 * steps + 1; ++n, at += each) {
    (n < steps ? residual.force : residual.position)
        .emplace_back(packed.segment(at, each).reshaped(3, nodes));
  }
  return residual;
}

}  // namespace

std::vector<ResidualPattern> ResidualsOf(const Fitting& fitting,
                                         const std::vector<const Verdict*>& verdicts,
                                         double deviation, const WorkShare& share) {
  const Recording& recording = *fitting.recordings()[0].recording;
  const auto count = static_cast<int>(verdicts.size());
  std::vector<ResidualPattern> patterns(verdicts.size());
  fitting.journal().Stage(share, count, "finding the residual forces");
  ParallelFor(count, fitting.threads(), [&](int i) {
    const Verdict& verdict = *verdicts[static_cast<std::size_t>(i)];
    ResidualForceOptions options;
    options.controller_velocity = verdict.controller_velocity;
    options.substeps =
        static_cast<int>(std::ceil(DiagnosisRate(verdict.system, recording.fps) / recording.fps));
    options.deviation = deviation;
    options.difference = DirectionDifference(recording, false);
    PieceKey key = KeyOf("residual forces", verdict.descent.hypothesis);
    if (verdict.provenance == Verdict::Provenance::kTraining) key.Add("training");
    key.Add(verdict.system.effects).Add(verdict.system.stiffness).Add(verdict.system.dashpot);
    const Eigen::VectorXd packed = fitting.journal().Get(
        key, [&] { return Pack(FindResidualForce(verdict.system, recording, options)); });
    patterns[static_cast<std::size_t>(i)] =
        PatternOf(Unpack(packed, verdict.system.node_count()), verdict.system, recording.fps);
  });
  return patterns;
}

}  // namespace physpring
