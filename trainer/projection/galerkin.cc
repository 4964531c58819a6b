// SPDX-License-Identifier: Apache-2.0
#include "trainer/projection/galerkin.h"

#include <algorithm>
#include <array>
#include <map>

#include "trainer/projection/spring_graph.h"

namespace physpring {
namespace {

constexpr double kLeastPart = 0.1;         // of its reference length, for a projected rest length
constexpr double kLeastRestLength = 1e-4;  // m

Eigen::Vector3d Direction(const Points& position, const std::array<int, 2>& spring) {
  const Eigen::Vector3d d = position.col(spring[1]) - position.col(spring[0]);
  const double length = d.norm();
  return length > 0 ? Eigen::Vector3d(d / length) : Eigen::Vector3d::Zero();
}

std::vector<int> ClusterSizes(const std::vector<int>& cluster, int clusters) {
  std::vector<int> sizes(clusters, 0);
  for (int c : cluster) ++sizes[c];
  return sizes;
}

// Masses, positions and contact radii of the clusters of free nodes.
void ProjectNodes(const SpringMassSystem& fine, const Assignment& assignment,
                  const std::vector<int>& sizes, const Eigen::Vector3d& up,
                  SpringMassSystem* coarse) {
  const int clusters = CountClusters(assignment), nodes = fine.node_count();
  coarse->mass.setZero(clusters);
  coarse->position.setZero(3, clusters + fine.controllers);
  coarse->position.rightCols(fine.controllers) = fine.position.rightCols(fine.controllers);
  coarse->contact_radius.setZero(clusters);
  for (int i = 0; i < nodes; ++i) {
    const int cluster = assignment[i];
    coarse->mass[cluster] += fine.mass[i];
    if (sizes[cluster] == 1) coarse->position.col(cluster) = fine.position.col(i);
    if (sizes[cluster] > 1) coarse->position.col(cluster) += fine.mass[i] * fine.position.col(i);
  }
  for (int cluster = 0; cluster < clusters; ++cluster) {
    if (sizes[cluster] > 1) coarse->position.col(cluster) /= coarse->mass[cluster];
  }
  for (int i = 0; i < nodes; ++i) {
    const int cluster = assignment[i];
    const double below = up.dot(coarse->position.col(cluster) - fine.position.col(i));
    coarse->contact_radius[cluster] =
        std::max(coarse->contact_radius[cluster], fine.contact_radius[i] + below);
  }
}

// Sums over the fine springs of a coarse one.
struct SpringSum {
  double stiffness = 0, dashpot = 0;
  double force = 0;  // along the coarse spring, N
  int parts = 0;
  double rest_length = 0;  // of the last part
};

double RestLength(const SpringSum& sum, double length, bool copy) {
  if (copy) return sum.rest_length;
  const double rest = sum.stiffness > 0 ? length - sum.force / sum.stiffness : length;
  return std::max({rest, kLeastPart * length, kLeastRestLength});
}

void ProjectSprings(const SpringMassSystem& fine, const std::vector<int>& cluster,
                    const std::vector<int>& sizes, Projection* projection) {
  SpringMassSystem& coarse = projection->system;
  std::map<std::array<int, 2>, int> number;
  projection->spring.assign(fine.spring_count(), -1);
  std::vector<SpringSum> sums;
  for (int e = 0; e < fine.spring_count(); ++e) {
    const std::array<int, 2> ends = {cluster[fine.springs[e][0]], cluster[fine.springs[e][1]]};
    if (ends[0] == ends[1]) continue;
    const auto [found, is_new] = number.try_emplace(
        {std::min(ends[0], ends[1]), std::max(ends[0], ends[1])}, static_cast<int>(number.size()));
    if (is_new) {
      coarse.springs.push_back(ends);
      sums.emplace_back();
    }
    const int spring = found->second;
    const double length =
        (fine.position.col(fine.springs[e][1]) - fine.position.col(fine.springs[e][0])).norm();
    // the coarse spring may have been listed the other way round
    const double along = (ends == coarse.springs[spring] ? 1 : -1) *
                         Direction(fine.position, fine.springs[e])
                             .dot(Direction(coarse.position, coarse.springs[spring]));
    SpringSum& sum = sums[spring];
    sum.stiffness += fine.stiffness[e];
    sum.dashpot += fine.dashpot[e];
    sum.force += fine.stiffness[e] * (length - fine.rest_length[e]) * along;
    sum.rest_length = fine.rest_length[e];
    ++sum.parts;
    projection->spring[e] = spring;
  }
  const auto count = static_cast<Eigen::Index>(sums.size());
  coarse.stiffness.resize(count);
  coarse.dashpot.resize(count);
  coarse.rest_length.resize(count);
  for (Eigen::Index s = 0; s < count; ++s) {
    const auto [a, b] = coarse.springs[s];
    const bool copy = sums[s].parts == 1 && sizes[a] == 1 && sizes[b] == 1;
    coarse.stiffness[s] = sums[s].stiffness;
    coarse.dashpot[s] = sums[s].dashpot;
    coarse.rest_length[s] =
        RestLength(sums[s], (coarse.position.col(b) - coarse.position.col(a)).norm(), copy);
  }
}

// The median distance of a node to its nearest spring neighbour, m.
double Spacing(const SpringMassSystem& system) {
  const SpringGraph graph(system);
  std::vector<double> nearest;
  for (const auto& links : graph.links) {
    if (links.empty()) continue;
    nearest.push_back(
        std::min_element(links.begin(), links.end(), [](const auto& i, const auto& j) {
          return i.length < j.length;
        })->length);
  }
  if (nearest.empty()) return 0;
  std::nth_element(nearest.begin(), nearest.begin() + nearest.size() / 2, nearest.end());
  return nearest[nearest.size() / 2];
}

}  // namespace

Projection Project(const SpringMassSystem& fine, const Assignment& assignment,
                   const Eigen::Vector3d& up) {
  const int clusters = CountClusters(assignment);
  std::vector<int> cluster = assignment;  // controllers are clusters of their own
  for (int c = 0; c < fine.controllers; ++c) cluster.push_back(clusters + c);
  const std::vector<int> sizes = ClusterSizes(cluster, clusters + fine.controllers);

  Projection projection;
  projection.system.controllers = fine.controllers;
  projection.system.drag = fine.drag;
  projection.system.dashpot_stages = fine.dashpot_stages;
  projection.system.contact = fine.contact;
  projection.system.effects = fine.effects;
  ProjectNodes(fine, assignment, sizes, up, &projection.system);
  ProjectSprings(fine, cluster, sizes, &projection);
  // particles collide from as far as they lie apart
  if (fine.contact.collision_distance > 0 && clusters < fine.node_count()) {
    const double fine_spacing = Spacing(fine);
    if (fine_spacing > 0) {
      projection.system.contact.collision_distance *= Spacing(projection.system) / fine_spacing;
    }
  }
  return projection;
}

}  // namespace physpring
