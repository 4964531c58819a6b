// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/candidates.h"

#include <algorithm>

#include "trainer/bodies/bending_chain.h"
#include "trainer/bodies/hanging_net.h"
#include "trainer/bodies/particle_mass.h"
#include "trainer/bodies/spring_net.h"
#include "trainer/bodies/spring_radius.h"

namespace physpring {
namespace {

std::vector<int> NeighbourCounts(const Recording& recording, const TrainOptions& options) {
  std::vector<int> counts = options.neighbours;
  if (counts.empty()) {
    counts = !recording.rod.empty() ? std::vector<int>{12, 20} : std::vector<int>{18, 28, 40};
  }
  // more neighbours than there are particles are all the same
  const int most = std::max(1, recording.particle_count() - 1);
  for (int& count : counts) count = std::min(count, most);
  std::sort(counts.begin(), counts.end());
  counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
  return counts;
}

}  // namespace

std::vector<Body> CandidateBodies(const Recording& recording, const TrainOptions& options) {
  const Points particles = recording.rest.leftCols(recording.particle_count());
  std::vector<bool> velocities = {true, false};
  if (options.controller_velocity) velocities = {*options.controller_velocity};
  if (recording.controller_count() == 0) velocities.resize(1);
  std::vector<FrictionCone> cones = {FrictionCone::kElliptic};
  if (recording.ground) cones.push_back(FrictionCone::kPyramidal);
  if (options.cone) cones = {*options.cone};
  const Eigen::VectorXd masses = ParticleMasses(recording);
  const bool hangs = HangsAtRest(recording);
  std::vector<Body> candidates;
  double last_radius = 0;
  for (int count : NeighbourCounts(recording, options)) {
    const bool rod = !recording.rod.empty() || particles.cols() < 2;
    const double radius = rod ? 0 : SpringRadius(particles, count);
    if (!rod && radius < 1.02 * last_radius) continue;  // it reaches the same shells again
    last_radius = radius;
    for (FrictionCone cone : cones) {
      for (bool velocity : velocities) {
        candidates.push_back(
            {&SpringNet(), count, radius, velocity, cone, options.effects, masses});
        if (hangs) candidates.push_back(HangingNet(recording, candidates.back()));
      }
    }
  }
  if (!recording.rod.empty() && options.neighbours.empty()) {
    const Body chain = BendingChain(recording, candidates[0]);
    // nets fit a rod with branches no better and predict it far worse
    if (!IsPlain(recording.rod)) candidates.clear();
    candidates.push_back(chain);
    if (RodJoints(recording.rod) > 0) {
      candidates.push_back(chain);
      candidates.back().braced_joints = false;
    }
  }
  return candidates;
}

}  // namespace physpring
