// SPDX-License-Identifier: Apache-2.0
#include "trainer/motion/motion_problem.h"

#include <algorithm>
#include <map>
#include <utility>

#include "twin/parallel.h"

namespace physpring {

MotionProblem::MotionProblem(SystemMap map, std::vector<Episode> episodes, const Options& options)
    : map_(std::move(map)),
      motion_(std::move(episodes), options),
      difference_(options.difference),
      keep_substeps_(options.keep_substeps) {
  CountResiduals();
}

MotionProblem::MotionProblem(SystemMap map, LiftedMotion motion, double difference)
    : map_(std::move(map)), motion_(std::move(motion)), difference_(difference) {
  CountResiduals();
}

void MotionProblem::CountResiduals() {
  for (int e = 0; e < motion_.episode_count(); ++e) {
    std::size_t seen = 0;
    ForEachSeen(motion_.episode(e), FrameUse::kFit, [&](int, int) { ++seen; });
    offset_.push_back(offset_.back() + 3 * seen);
  }
}

void MotionProblem::SetResiduals(int e, const std::vector<Points>& particles,
                                 Eigen::VectorXd* residuals) const {
  const Recording& recording = *motion_.episode(e).recording;
  const std::vector<Points>& measured = recording.points;
  std::size_t row = offset_[e];
  ForEachSeen(motion_.episode(e), FrameUse::kFit, [&](int frame, int point) {
    residuals->segment<3>(row) = std::sqrt(recording.WeightOf(frame, point)) *
                                 (particles[frame].col(point) - measured[frame].col(point));
    row += 3;
  });
}

bool MotionProblem::FixSubsteps(const Eigen::VectorXd& x) {
  substeps_ = motion_.SubstepsOf(SystemAt(x));
  return !substeps_.empty();
}

std::optional<Eigen::VectorXd> MotionProblem::RollOutAll(
    const SpringMassSystem& system, const LiftedMotion::Substeps& substeps,
    std::vector<LiftedMotion::Motion>* motions) const {
  if (substeps.empty()) return {};
  const int episodes = motion_.episode_count();
  Eigen::VectorXd residuals(offset_.back());
  std::vector<char> diverged(offset_.size(), 0);
  if (motions) motions->resize(offset_.size() - 1);
  ParallelFor(episodes, motion_.threads(), [&](int e) {
    auto motion = motion_.RunOne(e, system, substeps);
    diverged[e] = motion ? 0 : 1;
    if (!motion) return;
    SetResiduals(e, motion->particles(), &residuals);
    if (motions) (*motions)[e] = std::move(*motion);
  });
  if (std::any_of(diverged.begin(), diverged.end(), [](char d) { return d != 0; })) return {};
  return residuals;
}

LiftedMotion::Substeps MotionProblem::SubstepsFor(const SpringMassSystem& system) const {
  if (!keep_substeps_) return motion_.SubstepsOf(system);
  return motion_.AreEnough(substeps_, system) ? substeps_ : LiftedMotion::Substeps();
}

std::vector<std::optional<Eigen::VectorXd>> MotionProblem::RollOutSideBySide(
    const std::vector<SpringMassSystem>& systems, const LiftedMotion::Substeps& substeps) const {
  std::vector<std::vector<std::optional<std::vector<Points>>>> particles(offset_.size() - 1);
  ParallelFor(motion_.episode_count(), motion_.threads(),
              [&](int e) { particles[e] = motion_.RunSideBySide(e, systems, substeps); });
  std::vector<std::optional<Eigen::VectorXd>> all(systems.size());
  for (std::size_t i = 0; i < systems.size(); ++i) {
    if (!std::all_of(particles.begin(), particles.end(), [&](auto& of) { return of[i]; })) continue;
    all[i] = Eigen::VectorXd(offset_.back());
    for (int e = 0; e < motion_.episode_count(); ++e) SetResiduals(e, *particles[e][i], &*all[i]);
  }
  return all;
}

std::vector<std::optional<Eigen::VectorXd>> MotionProblem::Residuals(
    const std::vector<Eigen::VectorXd>& xs) const {
  std::vector<SpringMassSystem> systems;
  for (const Eigen::VectorXd& x : xs) systems.push_back(SystemAt(x));
  return ResidualsOfSystems(std::move(systems));
}

std::vector<std::optional<Eigen::VectorXd>> MotionProblem::ResidualsOfSystems(
    std::vector<SpringMassSystem> systems) const {
  // side by side go those that take equal sub-steps
  struct Group {
    std::vector<SpringMassSystem> systems;
    std::vector<std::size_t> places;
  };
  std::map<LiftedMotion::Substeps, Group> groups;
  for (std::size_t i = 0; i < systems.size(); ++i) {
    Group& group = groups[SubstepsFor(systems[i])];
    group.systems.push_back(std::move(systems[i]));
    group.places.push_back(i);
  }
  std::vector<std::optional<Eigen::VectorXd>> all(systems.size());
  for (const auto& [substeps, group] : groups) {
    if (substeps.empty()) continue;
    auto residuals = RollOutSideBySide(group.systems, substeps);
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      all[group.places[i]] = std::move(residuals[i]);
    }
  }
  return all;
}

std::optional<Eigen::VectorXd> MotionProblem::Residuals(const Eigen::VectorXd& x) {
  return Residuals(std::vector<Eigen::VectorXd>{x})[0];
}

std::optional<Eigen::VectorXd> MotionProblem::Linearise(const Eigen::VectorXd& x) {
  x_ = x;
  system_ = SystemAt(x);
  substeps_ = motion_.SubstepsOf(system_);
  auto residuals = RollOutAll(system_, substeps_, &motions_);
  if (residuals) r_ = *residuals;
  return residuals;
}

Eigen::VectorXd MotionProblem::JacobianTimes(const Eigen::VectorXd& v) {
  const double step = difference_ / std::max(1e-300, v.cwiseAbs().maxCoeff());
  const auto moved = RollOutAll(SystemAt(x_ + step * v), substeps_, nullptr);
  if (!moved) return Eigen::VectorXd::Zero(r_.size());
  return (*moved - r_) / step;
}

Eigen::VectorXd MotionProblem::JacobianTransposedTimes(const Eigen::VectorXd& u) {
  const auto particles_bar = [&](int e) {
    std::vector<Points> bars = LiftedMotion::ZerosLike(motions_[e].particles());
    std::size_t row = offset_[e];
    ForEachSeen(motion_.episode(e), FrameUse::kFit, [&](int frame, int point) {
      const double weight = motion_.episode(e).recording->WeightOf(frame, point);
      bars[frame].col(point) = std::sqrt(weight) * u.segment<3>(row);
      row += 3;
    });
    return bars;
  };
  return map_.Adjoint(x_, system_, motion_.Adjoint(system_, motions_, particles_bar, &cuts_));
}

}  // namespace physpring
