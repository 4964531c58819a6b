// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/particle_mass.h"

#include <algorithm>
#include <vector>

#include "twin/neighbours.h"

namespace physpring {
namespace {

constexpr int kNeighbourhood = 18;  // neighbours of a particle; on a grid those up to a diagonal
constexpr int kSamples = 4000;      // places that are tried in a box around a particle
constexpr double kBox = 0.75;       // the box's half width, as a part of the neighbourhood's radius
constexpr double kLeastShare = 0.2;  // the least mass of a particle, as a part of the mean mass
constexpr double kWithin = 1.25;  // a controller nearer than so many spacings is part of the body
constexpr int kSteps = 60;        // most steps of the search for a separating plane
// The distance that counts as touching, as a part of the neighbourhood's radius.
constexpr double kTouching = 1e-3;

// Whether `place` lies in the convex hull of `points`: Gilbert's algorithm walks from a point of
// the hull towards the one nearest to `place`, until a plane through it separates the two.
bool InHull(const Points& points, const Eigen::Vector3d& place, double touching) {
  Eigen::Vector3d nearest = points.col(0) - place;
  for (int step = 0; step < kSteps && nearest.norm() > touching; ++step) {
    Eigen::Index extreme;
    const double height = (nearest.transpose() * (points.colwise() - place)).minCoeff(&extreme);
    if (height > 0) return false;
    const Eigen::Vector3d edge = points.col(extreme) - place - nearest;
    nearest += std::clamp(-nearest.dot(edge) / edge.squaredNorm(), 0.0, 1.0) * edge;
  }
  return true;
}

// The i-th place of a sequence that fills the cube [-1, 1]^3 evenly, and never on a grid, where
// places would lie between cells (Roberts' additive recurrence).
Eigen::Vector3d EvenPlace(int i) {
  const Eigen::Vector3d ratio(0.8191725133961645, 0.6710436067037893, 0.5497004779019703);
  const Eigen::Vector3d place = i * ratio;
  return 2 * (place.array() - place.array().floor()) - 1;
}

// Volume of the cell of the first of `points` among them and in their hull.
double CellVolume(const Points& points) {
  const Points offsets = points.rightCols(points.cols() - 1).colwise() - points.col(0);
  const double radius = offsets.colwise().norm().maxCoeff();
  const double half_width = kBox * radius;
  // an offset p is nearer to the particle than to its neighbour d if p . d < |d|^2 / 2
  const Eigen::VectorXd half = offsets.colwise().squaredNorm() / 2;
  int inside = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Eigen::Vector3d offset = half_width * EvenPlace(i);
    if (((offsets.transpose() * offset).array() >= half.array()).any()) continue;
    inside += InHull(points, points.col(0) + offset, kTouching * radius);
  }
  return 8 * half_width * half_width * half_width * inside / kSamples;
}

// A controller that is a part of the body, as at a clamped face, and the particle nearest to it.
struct Held {
  int controller, particle;
};

// Controllers that are no farther from a particle than particles mostly are from each other. Others
// are a hand that touches the body from outside.
std::vector<Held> HeldParts(const Recording& recording) {
  const Points particles = recording.rest.leftCols(recording.particle_count());
  const NeighbourSearch search(particles);
  const double reach = kWithin * MedianSpacing(particles);
  std::vector<Held> held;
  for (int i = 0; i < recording.controller_count(); ++i) {
    const Neighbour near = search.Nearest(recording.rest.col(particles.cols() + i), 1).front();
    if (near.distance < reach) held.push_back({i, near.index});
  }
  return held;
}

}  // namespace

Eigen::VectorXd CellVolumes(const Points& particles) {
  const NeighbourSearch search(particles);
  Eigen::VectorXd volumes = Eigen::VectorXd::Zero(particles.cols());
  for (int i = 0; i < particles.cols(); ++i) {
    const std::vector<Neighbour> near = search.Nearest(particles.col(i), kNeighbourhood + 1);
    if (near.size() < 4 || near.back().distance == 0) continue;
    Points points(3, near.size());
    points.col(0) = particles.col(i);
    int count = 1;
    for (const Neighbour& other : near) {
      if (other.index != i) points.col(count++) = particles.col(other.index);
    }
    volumes[i] = CellVolume(points.leftCols(count));
  }
  return volumes;
}

Eigen::VectorXd ParticleMasses(const Recording& recording) {
  const int count = recording.particle_count();
  Eigen::VectorXd masses = Eigen::VectorXd::Constant(count, recording.mass / count);
  const bool unseen = recording.interior_count() > recording.point_count();
  if (!unseen || !recording.rod.empty()) return masses;
  const std::vector<Held> held = HeldParts(recording);
  Points body(3, count + static_cast<Eigen::Index>(held.size()));
  body.leftCols(count) = recording.rest.leftCols(count);
  for (std::size_t i = 0; i < held.size(); ++i) {
    body.col(count + static_cast<Eigen::Index>(i)) = recording.rest.col(count + held[i].controller);
  }
  const Eigen::VectorXd volumes = CellVolumes(body);
  if (volumes.sum() == 0) return masses;
  masses = volumes.head(count);
  for (std::size_t i = 0; i < held.size(); ++i) {
    masses[held[i].particle] += volumes[count + static_cast<Eigen::Index>(i)];
  }
  masses = masses.cwiseMax(kLeastShare * masses.mean()).eval();
  return masses * (recording.mass / masses.sum());
}

}  // namespace physpring
