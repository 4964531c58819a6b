// SPDX-License-Identifier: Apache-2.0
#include "trainer/diagnosis/diagnosis_body.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "trainer/fit_model.h"
#include "twin/effects/registry.h"
#include "twin/topology.h"

namespace physpring {
namespace {

// Of an inner particle, about: on a sheet the first two, three, four shells of a regular grid, in
// a solid the first two, the first three and part of the fourth.
constexpr int kNeighbours[] = {12, 18, 28};

// Of the squared lengths of the springs at a node of a solid, the part across a plane, at least. A
// third where they spread evenly.
constexpr double kSolid = 0.03;

constexpr double kStart = 8;  // sub-steps a frame; the fit looks for a better start itself

// Springs of equal axial stiffness and of their reference lengths, equal dashpots.
SpringMassSystem MakeAlike(const SpringMassSystem& system) {
  SpringMassSystem alike = system;
  alike.rest_length = SpringLengths(system.springs, system.position, system.order);
  alike.stiffness = alike.rest_length.cwiseInverse();
  alike.dashpot.setOnes();
  return alike;
}

// The recording with the stress-free shape that the twin knows.
Recording WithShapeOf(const SpringMassSystem& system, const Recording& recording) {
  Recording shaped = recording;
  shaped.rest = system.position;
  shaped.order = system.order;
  shaped.mass = system.mass.sum();
  return shaped;
}

}  // namespace

bool IsBendingChain(const SpringMassSystem& system) {
  const bool bends = std::any_of(system.effects.begin(), system.effects.end(),
                                 [](const EffectValues& e) { return GetEffect(e.name).bends(); });
  if (!bends || system.order.size() == 0) return false;
  const int nodes = system.node_count();
  std::vector<int> along(nodes), place(nodes);
  std::iota(along.begin(), along.end(), 0);
  std::sort(along.begin(), along.end(),
            [&](int i, int j) { return system.order[i] < system.order[j]; });
  for (int i = 0; i < nodes; ++i) place[along[i]] = i;
  return std::all_of(system.springs.begin(), system.springs.end(), [&](const auto& spring) {
    const bool controlled = std::max(spring[0], spring[1]) >= nodes;
    return controlled || std::abs(place[spring[0]] - place[spring[1]]) == 1;
  });
}

std::vector<DiagnosisBody> BodiesOf(const Twin& twin, const Recording& recording, bool trained_on) {
  const bool chain = IsBendingChain(twin.levels[0].system);
  DiagnosisBody own{twin.levels[0].system, twin.controller_velocity, chain || !trained_on,
                    "as trained"};
  if (chain) return {own};
  own.base.effects.clear();
  if (!trained_on) return {own};
  own.base = MakeAlike(own.base);
  std::vector<DiagnosisBody> bodies = {own};
  TrainOptions options;
  if (twin.order.size() == 0) {
    options.neighbours.assign(std::begin(kNeighbours), std::end(kNeighbours));
  }
  options.cone = own.base.contact.cone;
  const Recording shaped = WithShapeOf(own.base, recording);
  for (const Candidate& candidate : Candidates(shaped, options)) {
    SpringMassSystem system = StartSystem(shaped, candidate, kStart);
    system.mass = own.base.mass;
    system.effects.clear();
    const bool known = std::any_of(bodies.begin(), bodies.end(), [&](const DiagnosisBody& body) {
      return body.controller_velocity == candidate.controller_velocity &&
             body.base.springs == system.springs;
    });
    if (!known) {
      bodies.push_back({system, candidate.controller_velocity, false, candidate.Label()});
    }
  }
  return bodies;
}

bool IsSolid(const SpringMassSystem& system) {
  if (system.order.size() > 0) return false;
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
