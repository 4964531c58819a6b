// SPDX-License-Identifier: Apache-2.0
#include "trainer/solvers/cma_es.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <random>

#include "twin/uniform.h"

namespace physpring {
namespace {

// Widths of the quadratic ends of the fold, at 0 and at 1.
constexpr double kLow = 0.05, kHigh = 0.1;

// Into [0, 1], from anywhere: periodic, mirrored at -kLow and 1 + kHigh, quadratic within kLow of 0
// and kHigh of 1.
double Fold(double x) {
  const double span = 1 + kLow + kHigh;
  x = std::fmod(x + kLow, 2 * span);
  if (x < 0) x += 2 * span;
  x = std::min(x, 2 * span - x) - kLow;
  if (x < kLow) return (x + kLow) * (x + kLow) / (4 * kLow);
  if (x > 1 - kHigh) return 1 - (x - 1 - kHigh) * (x - 1 - kHigh) / (4 * kHigh);
  return x;
}

// The inverse of Fold, in [-kLow, 1 + kHigh].
double Unfold(double y) {
  if (y < kLow) return 2 * std::sqrt(kLow * y) - kLow;
  if (y > 1 - kHigh) return 1 + kHigh - 2 * std::sqrt(kHigh * (1 - y));
  return y;
}

// Normal deviates by Box and Muller: std::normal_distribution differs between libraries.
class NormalSource {
 public:
  NormalSource(std::uint64_t seed, int generation) {
    std::seed_seq words{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                        static_cast<std::uint32_t>(generation)};
    generator_.seed(words);
  }

  Eigen::VectorXd Vector(Eigen::Index size) {
    Eigen::VectorXd z(size);
    for (double& value : z) value = Normal(&generator_);
    return z;
  }

 private:
  std::mt19937_64 generator_;
};

// C^power, for power 1/2 and -1/2.
Eigen::MatrixXd Power(const Eigen::MatrixXd& covariance, double power) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  // rounding must not make an eigenvalue negative
  const Eigen::VectorXd values = eigen.eigenvalues().cwiseMax(1e-300);
  return eigen.eigenvectors() * values.array().pow(power).matrix().asDiagonal() *
         eigen.eigenvectors().transpose();
}

// The tutorial's default constants (its table 1), for n variables.
struct Constants {
  double c_sigma, d_sigma, c_c, c_1, c_mu;
  double chi;  // the mean of |N(0, I)|

  Constants(double n, double mu_eff)
      : c_sigma((mu_eff + 2) / (n + mu_eff + 5)),
        d_sigma(1 + 2 * std::max(0.0, std::sqrt((mu_eff - 1) / (n + 1)) - 1) + c_sigma),
        c_c((4 + mu_eff / n) / (n + 4 + 2 * mu_eff / n)),
        c_1(2 / ((n + 1.3) * (n + 1.3) + mu_eff)),
        c_mu(std::min(1 - c_1, 2 * (mu_eff - 2 + 1 / mu_eff) / ((n + 2) * (n + 2) + mu_eff))),
        chi(std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n))) {}
};

double NumberOrWorst(double objective) {
  return std::isnan(objective) ? std::numeric_limits<double>::infinity() : objective;
}

}  // namespace

CmaEs::CmaEs(const Eigen::VectorXd& start, double step_size, std::uint64_t seed, int population)
    : seed_(seed), population_(population) {
  const Eigen::Index n = start.size();
  if (population_ == 0) population_ = 4 + static_cast<int>(3 * std::log(static_cast<double>(n)));
  weight_ = Eigen::VectorXd::Zero(population_ / 2);
  for (Eigen::Index i = 0; i < weight_.size(); ++i) {
    weight_[i] = std::log((population_ + 1) / 2.0) - std::log(static_cast<double>(i + 1));
  }
  weight_ /= weight_.sum();
  mu_eff_ = 1 / weight_.squaredNorm();
  state_.step_size = step_size;
  state_.mean = start.unaryExpr(&Unfold);
  state_.covariance = Eigen::MatrixXd::Identity(n, n);
  state_.step_path = state_.path = Eigen::VectorXd::Zero(n);
  state_.best = start;
}

std::vector<Eigen::VectorXd> CmaEs::Sample() const {
  NormalSource normal(seed_, state_.generation);
  const Eigen::MatrixXd root = Power(state_.covariance, 0.5);
  std::vector<Eigen::VectorXd> points;
  for (int k = 0; k < population_; ++k) {
    const Eigen::VectorXd z = normal.Vector(state_.mean.size());
    points.emplace_back(state_.mean + state_.step_size * (root * z));
  }
  return points;
}

std::vector<Eigen::VectorXd> CmaEs::Ask() const {
  std::vector<Eigen::VectorXd> points = Sample();
  for (Eigen::VectorXd& point : points) point = point.unaryExpr(&Fold).eval();
  return points;
}

void CmaEs::Tell(const std::vector<double>& objective) {
  assert(static_cast<int>(objective.size()) == population_);
  const std::vector<Eigen::VectorXd> points = Sample();
  std::vector<int> rank(population_);  // candidates, best first
  std::iota(rank.begin(), rank.end(), 0);
  std::stable_sort(rank.begin(), rank.end(), [&](int i, int j) {
    return NumberOrWorst(objective[i]) < NumberOrWorst(objective[j]);
  });
  if (objective[rank[0]] < state_.best_objective) {
    state_.best = points[rank[0]].unaryExpr(&Fold);
    state_.best_objective = objective[rank[0]];
  }

  const double n = static_cast<double>(state_.mean.size());
  const Constants c(n, mu_eff_);

  // y_i = (x_i - m) / sigma of the better half; m <- m + sigma sum w_i y_i
  Eigen::MatrixXd y(state_.mean.size(), weight_.size());
  for (Eigen::Index i = 0; i < weight_.size(); ++i) {
    y.col(i) = (points[rank[i]] - state_.mean) / state_.step_size;
  }
  const Eigen::VectorXd y_mean = y * weight_;
  state_.mean += state_.step_size * y_mean;

  // p_sigma <- (1 - c_sigma) p_sigma + sqrt(c_sigma (2 - c_sigma) mu_eff) C^-1/2 y_mean
  ++state_.generation;
  const Eigen::MatrixXd whiten = Power(state_.covariance, -0.5);
  state_.step_path = (1 - c.c_sigma) * state_.step_path +
                     std::sqrt(c.c_sigma * (2 - c.c_sigma) * mu_eff_) * (whiten * y_mean);
  const double length = state_.step_path.norm();

  // p_c <- (1 - c_c) p_c + h sqrt(c_c (2 - c_c) mu_eff) y_mean; it stalls while p_sigma is long
  const double grown = 1 - std::pow(1 - c.c_sigma, 2 * state_.generation);
  const bool moves = length / std::sqrt(grown) < (1.4 + 2 / (n + 1)) * c.chi;
  state_.path *= 1 - c.c_c;
  if (moves) state_.path += std::sqrt(c.c_c * (2 - c.c_c) * mu_eff_) * y_mean;

  // C <- (1 - c_1 - c_mu) C + c_1 p_c p_c^T + c_mu sum w_i y_i y_i^T
  const double lost = moves ? 0 : c.c_1 * c.c_c * (2 - c.c_c);
  state_.covariance = (1 - c.c_1 - c.c_mu + lost) * state_.covariance +
                      c.c_1 * state_.path * state_.path.transpose() +
                      c.c_mu * y * weight_.asDiagonal() * y.transpose();
  state_.covariance = (0.5 * (state_.covariance + state_.covariance.transpose())).eval();
  state_.step_size *= std::exp(c.c_sigma / c.d_sigma * (length / c.chi - 1));
}

}  // namespace physpring
