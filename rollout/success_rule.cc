// SPDX-License-Identifier: Apache-2.0
#include "rollout/success_rule.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "rollout/task_fields.h"
#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

bool Contains(const Eigen::Vector3d& half, const Eigen::Vector3d& local) {
  return (local.array().abs() <= half.array()).all();
}

// Springs that pass through a box from one open face to the other, as a rope through a clip.
class SpringsThrough : public SuccessRule {
 public:
  SpringsThrough(const JsonFields& numbers, const SpringMassSystem& system)
      : box_(ReadBox(numbers.Object("box"))), least_(numbers.Count("springs")) {
    numbers.ExpectOnly({"box", "springs"});
    for (const auto& [a, b] : system.springs) {
      if (std::max(a, b) < system.node_count()) springs_.push_back({a, b});
    }
    if (least_ < 1 || least_ > static_cast<int>(springs_.size())) {
      numbers.Fail("springs", fmt::format("must be 1 to {}, as the twin has", springs_.size()));
    }
  }

  Verdict Judge(const Points& particles) const override {
    const Points local = box_.pose.ToLocal(particles);
    const int least = std::min(Crossing(local, -box_.half.y()), Crossing(local, box_.half.y()));
    return {least >= least_, static_cast<double>(least)};
  }

 private:
  // Springs that cross the plane y inside the box's rectangle.
  int Crossing(const Points& local, double y) const {
    int count = 0;
    for (const auto& [a, b] : springs_) {
      const double from = local(1, a) - y, to = local(1, b) - y;
      if ((from < 0) == (to < 0)) continue;
      const Eigen::Vector3d at = local.col(a) + from / (from - to) * (local.col(b) - local.col(a));
      count += std::abs(at.x()) <= box_.half.x() && std::abs(at.z()) <= box_.half.z() ? 1 : 0;
    }
    return count;
  }

  Box box_;
  int least_;
  std::vector<std::array<int, 2>> springs_;
};

class ParticlesInside : public SuccessRule {
 public:
  explicit ParticlesInside(const JsonFields& numbers)
      : box_(ReadBox(numbers.Object("box"))),
        fraction_(PositiveNumberOr(numbers, "fraction", 1, 1)) {
    numbers.ExpectOnly({"box", "fraction"});
  }

  Verdict Judge(const Points& particles) const override {
    const Points local = box_.pose.ToLocal(particles);
    int inside = 0;
    for (int i = 0; i < local.cols(); ++i) inside += Contains(box_.half, local.col(i)) ? 1 : 0;
    const double fraction = static_cast<double>(inside) / static_cast<double>(local.cols());
    return {fraction >= fraction_, fraction};
  }

 private:
  Box box_;
  double fraction_;
};

class NearTarget : public SuccessRule {
 public:
  NearTarget(const JsonFields& numbers, const SpringMassSystem& system)
      : target_(ReadPose(numbers.Object("target"))
                    .ToWorld(system.position.leftCols(system.node_count()))),
        most_(PositiveNumber(numbers, "mean_squared_distance", kFarthest * kFarthest)) {
    numbers.ExpectOnly({"target", "mean_squared_distance"});
  }

  Verdict Judge(const Points& particles) const override {
    const double mean = (particles - target_).colwise().squaredNorm().mean();
    return {mean <= most_, mean};
  }

 private:
  Points target_;
  double most_;  // m^2
};

class PairsClose : public SuccessRule {
 public:
  PairsClose(const JsonFields& numbers, const SpringMassSystem& system)
      : most_(PositiveNumber(numbers, "distance", kFarthest)) {
    numbers.ExpectOnly({"pairs", "distance"});
    for (const std::vector<int>& pair : numbers.WholeNumberLists("pairs")) {
      if (pair.size() != 2 || std::min(pair[0], pair[1]) < 0 ||
          std::max(pair[0], pair[1]) >= system.node_count()) {
        numbers.Fail("pairs", fmt::format("must be pairs of numbers below {}, as the twin has "
                                          "particles",
                                          system.node_count()));
      }
      pairs_.push_back({pair[0], pair[1]});
    }
    if (pairs_.empty()) numbers.Fail("pairs", "must not be empty");
  }

  Verdict Judge(const Points& particles) const override {
    double sum = 0;
    for (const auto& [a, b] : pairs_) sum += (particles.col(a) - particles.col(b)).norm();
    const double mean = sum / static_cast<double>(pairs_.size());
    return {mean <= most_, mean};
  }

 private:
  double most_;  // m
  std::vector<std::array<int, 2>> pairs_;
};

}  // namespace

std::unique_ptr<SuccessRule> MakeSuccessRule(const Task& task) {
  const std::string where = task.folder + "/task.json: success";
  const JsonFields numbers(task.success.numbers, where);
  const SpringMassSystem& system = task.twin.levels[0].system;
  const std::string& rule = task.success.rule;
  if (rule == "springs_through") return std::make_unique<SpringsThrough>(numbers, system);
  if (rule == "particles_inside") return std::make_unique<ParticlesInside>(numbers);
  if (rule == "near_target") return std::make_unique<NearTarget>(numbers, system);
  if (rule == "pairs_close") return std::make_unique<PairsClose>(numbers, system);
  throw Error(
      fmt::format("{}: rule {} is not known; there are springs_through, particles_inside, "
                  "near_target, pairs_close",
                  where, Quote(rule)));
}

}  // namespace physpring
