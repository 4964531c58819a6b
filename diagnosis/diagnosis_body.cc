// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/diagnosis_body.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "trainer/bodies/bending_chain.h"
#include "trainer/bodies/candidates.h"
#include "trainer/bodies/smooth_body.h"
#include "trainer/bodies/spring_net.h"
#include "twin/topology.h"

namespace physpring {
namespace {

// About so many neighbours of an inner particle are tried: on a sheet the first two, three, four
// shells of a regular grid, in a solid the first two, the first three and part of the fourth.
constexpr int kNeighbours[] = {12, 18, 28};

// At a node of a solid, at least this part of its springs' squared lengths is across any plane. It
// is a third where springs spread evenly.
constexpr double kSolid = 0.03;

constexpr double kStart = 8;  // sub-steps a frame; the fit looks for a better start itself

// Springs of equal axial stiffness and of their reference lengths, equal dashpots.
SpringMassSystem MakeAlike(const SpringMassSystem& system) {
  SpringMassSystem alike = system;
  alike.rest_length = SpringLengths(system.springs, system.position, system.rod);
  alike.stiffness = alike.rest_length.cwiseInverse();
  alike.dashpot.setOnes();
  return alike;
}

// The system as it was trained, but smooth; `alike` has its springs.
SpringMassSystem SmoothlyAs(const SpringMassSystem& trained, const SpringMassSystem& alike,
                            const Recording& recording) {
  const double any_rate = 1e9;
  return SmoothBody(alike, recording, SpringNet(), {any_rate}).NearestTo(trained);
}

// The recording with the stress-free shape that the twin knows.
Recording WithShapeOf(const SpringMassSystem& system, const Recording& recording) {
  Recording shaped = recording;
  shaped.rest = system.position;
  shaped.rod = system.rod;
  shaped.mass = system.mass.sum();
  return shaped;
}

}  // namespace

std::vector<DiagnosisBody> BodiesOf(const Twin& twin, const Recording& recording, bool trained_on) {
  using Kind = DiagnosisBody::Kind;
  DiagnosisBody trained{twin.levels[0].system, twin.controller_velocity, Kind::kTrained,
                        "as trained"};
  if (IsBendingChain(trained.base)) {
    trained.kind = Kind::kTrusted;
    return {trained};
  }
  trained.base.effects.clear();
  if (!trained_on) return {trained};
  DiagnosisBody own = trained;
  own.kind = Kind::kOpen;
  own.base = MakeAlike(own.base);
  trained.base = SmoothlyAs(trained.base, own.base, recording);
  std::vector<DiagnosisBody> bodies = {own};
  TrainOptions options;
  if (twin.rod.empty()) {
    options.neighbours.assign(std::begin(kNeighbours), std::end(kNeighbours));
  }
  options.cone = own.base.contact.surface.cone;
  const Recording shaped = WithShapeOf(own.base, recording);
  for (const Body& candidate : CandidateBodies(shaped, options)) {
    SpringMassSystem system = StartSystem(shaped, candidate, kStart);
    system.mass = own.base.mass;
    system.dashpot_stages = own.base.dashpot_stages;
    system.effects.clear();
    const bool known = std::any_of(bodies.begin(), bodies.end(), [&](const DiagnosisBody& body) {
      return body.controller_velocity == candidate.controller_velocity &&
             body.base.springs == system.springs;
    });
    if (!known) {
      bodies.push_back({system, candidate.controller_velocity, Kind::kOpen, candidate.Label()});
    }
  }
  bodies.push_back(trained);
  return bodies;
}

bool IsSolid(const SpringMassSystem& system) {
  if (!system.rod.empty()) return false;
  std::vector<Eigen::Matrix3d> spread(system.position.cols(), Eigen::Matrix3d::Zero());
  for (const auto& [a, b] : system.springs) {
    const Eigen::Vector3d d = system.position.col(b) - system.position.col(a);
    spread[a] += d * d.transpose();
    spread[b] += d * d.transpose();
  }
  int solid = 0;
  for (int i = 0; i < system.node_count(); ++i) {
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread[i]).eigenvalues()[0];
    if (least > kSolid * spread[i].trace()) ++solid;
  }
  return 2 * solid > system.node_count();
}

}  // namespace physpring
