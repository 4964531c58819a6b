// SPDX-License-Identifier: Apache-2.0
#include "trainer/fits/free_motion_search.h"

#include <limits>

#include "trainer/fits/free_motion_error.h"
#include "twin/parallel.h"

namespace physpring {
namespace {

constexpr double kReach = 4;         // how far each factor (parameters.h) may go either way
constexpr double kDeviation = 0.25;  // standard deviation of a factor in the first generation
constexpr int kMostGenerations = 60;
constexpr int kGenerationPatience = 10;
// A fall of the error to less than this part of it is worth as many generations again.
constexpr double kWorthwhile = 0.99;

}  // namespace

FreeMotionSearch::FreeMotionSearch(const Eigen::VectorXd& factors, const std::vector<int>& entries,
                                   int generations, std::uint64_t seed)
    : start_(factors),
      entries_(entries),
      generations_(generations),
      search_(Eigen::VectorXd::Constant(static_cast<Eigen::Index>(entries.size()), 0.5),
              kDeviation / (2 * kReach), seed),
      gained_error_(std::numeric_limits<double>::infinity()) {}

Eigen::VectorXd FreeMotionSearch::FactorsAt(const Eigen::VectorXd& point) const {
  Eigen::VectorXd factors = start_;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    factors[entries_[i]] += kReach * (2 * point[static_cast<Eigen::Index>(i)] - 1);
  }
  return factors;
}

bool FreeMotionSearch::done() const {
  const int generation = search_.state().generation;
  if (generations_ > 0) return generation >= generations_;
  return generation >= kMostGenerations || slow_ >= kGenerationPatience;
}

double FreeMotionSearch::Progress() const {
  const int all = generations_ > 0 ? generations_ : kMostGenerations;
  return done() ? 1 : static_cast<double>(search_.state().generation) / all;
}

void FreeMotionSearch::Step(const ChosenBody& model, const std::vector<Episode>& episodes,
                            const TrainOptions& options) {
  const FreeMotionError free_motions(model, episodes, options);
  const auto error = [&](const Eigen::VectorXd& point) { return free_motions(FactorsAt(point)); };
  if (search_.state().generation == 0) {
    gained_error_ = error(search_.state().best);
    search_.TellStart(gained_error_);
  }
  const std::vector<Eigen::VectorXd> points = search_.Ask();
  std::vector<double> errors(points.size());
  ParallelFor(static_cast<int>(points.size()), options.threads,
              [&](int i) { errors[i] = error(points[i]); });
  search_.Tell(errors);
  ++slow_;
  if (best_error() < kWorthwhile * gained_error_) {
    gained_error_ = best_error();
    slow_ = 0;
  }
}

}  // namespace physpring
