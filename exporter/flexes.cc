// SPDX-License-Identifier: Apache-2.0
#include "exporter/flexes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace physpring {
namespace {

constexpr int kIterations = 50;

// Labels (values) 0 to count-1 of k-means in one dimension, which starts from the quantiles.
std::vector<int> Cluster(const std::vector<double>& values, int count) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> centres;
  for (int i = 0; i < count; ++i) {
    centres.push_back(sorted[(2 * i + 1) * sorted.size() / (2 * static_cast<std::size_t>(count))]);
  }
  std::vector<int> labels(values.size());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<double> sums(centres.size()), members(centres.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto nearest = std::min_element(
          centres.begin(), centres.end(),
          [&](double a, double b) { return std::abs(a - values[i]) < std::abs(b - values[i]); });
      labels[i] = static_cast<int>(nearest - centres.begin());
      sums[labels[i]] += values[i];
      ++members[labels[i]];
    }
    for (std::size_t i = 0; i < centres.size(); ++i) {
      if (members[i] > 0) centres[i] = sums[i] / members[i];
    }
  }
  return labels;
}

double LogStiffness(const SpringMassSystem& system, int spring) {
  const double least = std::max(1e-9 * system.stiffness.maxCoeff(), 1e-300);
  return std::log(std::max(system.stiffness[spring], least));
}

FlexRounding MeasureRounding(const SpringMassSystem& system, const std::vector<FlexGroup>& groups) {
  FlexRounding rounding;
  int count = 0;
  for (const FlexGroup& group : groups) {
    for (const int e : group.springs) {
      const auto& [a, b] = system.springs[e];
      const double k = system.stiffness[e];
      const double stiffness = k > 0 ? std::abs(group.stiffness / k - 1) : 0;
      const double dashpot = std::abs(group.dashpot - system.dashpot[e]);
      const double length = (system.position.col(a) - system.position.col(b)).norm();
      rounding.stiffness_mean += stiffness;
      rounding.stiffness_max = std::max(rounding.stiffness_max, stiffness);
      rounding.dashpot_mean += dashpot;
      rounding.dashpot_max = std::max(rounding.dashpot_max, dashpot);
      rounding.rest_length_max =
          std::max(rounding.rest_length_max, std::abs(system.rest_length[e] - length));
      ++count;
    }
  }
  rounding.stiffness_mean /= std::max(count, 1);
  rounding.dashpot_mean /= std::max(count, 1);
  return rounding;
}

void AddFlex(const LevelPlan& plan, const FlexGroup& group, const std::string& name,
             XmlElement* deformable) {
  std::map<int, int> vertices;  // node -> vertex
  std::string bodies;
  std::vector<int> elements;
  for (const int e : group.springs) {
    for (const int node : plan.system().springs[e]) {
      const auto [vertex, added] = vertices.try_emplace(node, static_cast<int>(vertices.size()));
      if (added) bodies += plan.Vertex(node) + ' ';
      elements.push_back(vertex->second);
    }
  }
  XmlElement* flex = AddElement(deformable, "flex",
                                {{"name", name},
                                 {"dim", "1"},
                                 {"group", "4"},
                                 {"radius", "0.001"},
                                 {"body", bodies},
                                 {"element", Numbers(elements)}});
  AddElement(flex, "contact", {{"contype", "0"}, {"conaffinity", "0"}, {"selfcollide", "none"}});
  AddElement(flex, "edge",
             {{"stiffness", Number(group.stiffness)}, {"damping", Number(group.dashpot)}});
}

}  // namespace

FlexGroups GroupSprings(const SpringMassSystem& system, int count) {
  FlexGroups result;
  std::vector<int> edges;
  std::vector<double> logs;
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto& [a, b] = system.springs[e];
    if (std::max(a, b) >= system.node_count()) {
      result.tendons.push_back(e);
    } else {
      edges.push_back(e);
      logs.push_back(LogStiffness(system, e));
    }
  }
  if (edges.empty()) return result;
  const std::vector<int> labels = Cluster(logs, count);
  std::vector<FlexGroup> groups(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    FlexGroup& group = groups[labels[i]];
    group.springs.push_back(edges[i]);
    group.stiffness += logs[i];
    group.dashpot += system.dashpot[edges[i]];
  }
  std::erase_if(groups, [](const FlexGroup& group) { return group.springs.empty(); });
  for (FlexGroup& group : groups) {
    const double members = static_cast<double>(group.springs.size());
    group.stiffness = std::exp(group.stiffness / members);
    group.dashpot /= members;
  }
  result.groups = std::move(groups);
  result.rounding = MeasureRounding(system, result.groups);
  return result;
}

void AddFlexes(const LevelPlan& plan, const FlexGroups& flexes, XmlElement* mujoco) {
  if (flexes.groups.empty()) return;
  XmlElement* deformable = Section(mujoco, "deformable");
  for (std::size_t i = 0; i < flexes.groups.size(); ++i) {
    AddFlex(plan, flexes.groups[i], fmt::format("{}_springs_{}", plan.name, i), deformable);
  }
}

}  // namespace physpring
