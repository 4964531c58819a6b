// SPDX-License-Identifier: Apache-2.0
// CMA-ES (Hansen, "The CMA Evolution Strategy: A Tutorial", arXiv 1604.00772): minimises a function
// of few variables in the unit cube, from its values only. Rank-mu and rank-one update, cumulative
// step size, positive weights, the tutorial's default constants.
//
// The search itself is unbounded; a fold maps it into the cube: the identity but for quadratic ends
// (pycma's BoundTransform), so that no candidate is outside and none is lost. No restarts, no
// stopping rule: the caller counts.
#ifndef PHYSPRING_TRAINER_SOLVERS_CMA_ES_H_
#define PHYSPRING_TRAINER_SOLVERS_CMA_ES_H_

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

namespace physpring {

// All that the next generation depends on, besides seed and population. There are n variables.
struct CmaEsState {
  int generation = 0;          // how many were told
  double step_size = 0;        // sigma
  Eigen::VectorXd mean;        // (n), before the fold
  Eigen::MatrixXd covariance;  // C (n, n)
  Eigen::VectorXd step_path;   // p_sigma (n)
  Eigen::VectorXd path;        // p_c (n)
  Eigen::VectorXd best;        // (n) in the cube: the best that was told; at first the start
  double best_objective = std::numeric_limits<double>::infinity();

  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(generation, step_size, mean, covariance, step_path, path, best, best_objective);
  }
};

class CmaEs {
 public:
  // Starts around `start` (inside the cube) with standard deviation `step_size`. Population 0 is
  // 4 + floor(3 ln n).
  CmaEs(const Eigen::VectorXd& start, double step_size, std::uint64_t seed, int population = 0);

  int population() const { return population_; }

  // The candidates of this generation, in the cube; the same at each call until Tell.
  std::vector<Eigen::VectorXd> Ask() const;

  // Ends the generation. `objective` has a value for each candidate of Ask, in its order. Values
  // that are no numbers are worst.
  void Tell(const std::vector<double>& objective);

  // Gives `best` the start's objective: only what is better replaces the start.
  void TellStart(double objective) { state_.best_objective = objective; }

  const CmaEsState& state() const { return state_; }

  // What a journal keeps (journal/packing.h).
  template <class Visitor>
  void Visit(Visitor&& visit) {
    visit(state_);
  }

 private:
  std::vector<Eigen::VectorXd> Sample() const;  // the candidates before the fold

  std::uint64_t seed_;
  int population_;
  Eigen::VectorXd weight_;  // weights of the better half, best first; their sum is 1
  double mu_eff_;           // 1 / sum w^2
  CmaEsState state_;
};

}  // namespace physpring

#endif  // PHYSPRING_TRAINER_SOLVERS_CMA_ES_H_
