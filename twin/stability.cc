// SPDX-License-Identifier: Apache-2.0
#include "twin/stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "twin/dashpot_stages.h"
#include "twin/effects/effect_set.h"

namespace physpring {
namespace {

// A = M^-1/2 L M^-1/2, where (L x)_i is the sum over the springs at i of w (x_i - x_j), and
// controllers stay at 0.
class ScaledLaplacian {
 public:
  ScaledLaplacian(const SpringMassSystem& system, const Eigen::VectorXd& weight)
      : diagonal_(Eigen::VectorXd::Zero(system.node_count())) {
    const int nodes = system.node_count();
    for (int e = 0; e < system.spring_count(); ++e) {
      const auto [a, b] = system.springs[e];
      for (int end : {a, b}) {
        if (end < nodes) diagonal_[end] += weight[e] / system.mass[end];
      }
      if (a >= nodes || b >= nodes) continue;
      pairs_.push_back({a, b, weight[e] / std::sqrt(system.mass[a] * system.mass[b])});
    }
  }

  const Eigen::VectorXd& diagonal() const { return diagonal_; }

  Eigen::VectorXd operator*(const Eigen::VectorXd& x) const { return Times(x, -1); }

  // The same with the absolute values of all entries.
  Eigen::VectorXd AbsoluteTimes(const Eigen::VectorXd& x) const { return Times(x, 1); }

 private:
  Eigen::VectorXd Times(const Eigen::VectorXd& x, double sign) const {
    Eigen::VectorXd result = diagonal_.cwiseProduct(x);
    for (const Pair& pair : pairs_) {
      result.coeffRef(pair.a) += sign * pair.weight * x.coeff(pair.b);
      result.coeffRef(pair.b) += sign * pair.weight * x.coeff(pair.a);
    }
    return result;
  }

  struct Pair {
    int a, b;
    double weight;
  };
  Eigen::VectorXd diagonal_;
  std::vector<Pair> pairs_;
};

// The last entry of the eigenvector of length 1 of a symmetric tridiagonal matrix, without its
// sign: from that entry on upwards, where the entries of an outer eigenvalue grow.
double LastEntry(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside,
                 double eigenvalue) {
  double entry = 1, below = 0, squared_norm = 1;
  for (Eigen::Index i = diagonal.size() - 1; i > 0; --i) {
    const double coupling = i < diagonal.size() - 1 ? beside[i] : 0;
    const double above = ((eigenvalue - diagonal[i]) * entry - coupling * below) / beside[i - 1];
    below = entry;
    entry = above;
    squared_norm += entry * entry;
    if (squared_norm > 1e200) return 0;
  }
  return 1 / std::sqrt(squared_norm);
}

// The largest eigenvalue that was found, and a bound of its error.
struct Estimate {
  double eigenvalue, residual;
};

// The largest eigenvalue of a symmetric tridiagonal matrix, and the residual of its eigenvector in
// what the matrix is a projection of. The last entry of `beside` couples to the rest of that.
Estimate LargestOf(const Eigen::VectorXd& diagonal, const Eigen::VectorXd& beside) {
  const Eigen::Index size = diagonal.size();
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> projection;
  projection.computeFromTridiagonal(diagonal, beside.head(size - 1), Eigen::EigenvaluesOnly);
  const double largest = projection.eigenvalues()[size - 1];
  return {largest, beside[size - 1] * LastEntry(diagonal, beside, largest)};
}

// Lanczos' method from the vector q: the largest eigenvalue of the projection of A onto a Krylov
// space, and its residual. It ends where the residual is small.
Estimate Lanczos(const ScaledLaplacian& A, Eigen::VectorXd q) {
  constexpr Eigen::Index kMostSteps = 80, kLook = 16;  // looks at the residual after so many steps
  constexpr double kSmall = 1e-5;  // of the eigenvalue, whose error is its square
  const Eigen::Index steps = std::min(q.size(), kMostSteps);
  Eigen::VectorXd previous = Eigen::VectorXd::Zero(q.size());
  q.normalize();
  Eigen::VectorXd diagonal(steps), beside(steps);  // the projection's, on and beside its diagonal
  Eigen::Index size = 0;
  for (;;) {
    Eigen::VectorXd next = A * q;
    diagonal[size] = q.dot(next);
    next -= diagonal[size] * q;
    if (size > 0) next -= beside[size - 1] * previous;
    beside[size] = next.norm();
    ++size;
    // no residual: the space holds the eigenvectors
    const bool end = size == steps || beside[size - 1] <= 1e-12 * diagonal.head(size).maxCoeff();
    if (end || size % kLook == 0) {
      const Estimate found = LargestOf(diagonal.head(size), beside.head(size));
      if (end || found.residual < kSmall * found.eigenvalue) return found;
    }
    previous = q;
    q = next / beside[size - 1];
  }
}

// Upper estimate of the largest eigenvalue, from two start vectors, the same each time and without
// symmetry: one spread evenly, and one where the diagonal is large, as the modes of a few nodes are
// that uneven weights have at the top of the spectrum.
double LargestEigenvalue(const SpringMassSystem& system, const Eigen::VectorXd& weight) {
  const ScaledLaplacian A(system, weight);
  if (A.diagonal().isZero(0)) return 0;
  Eigen::VectorXd even(system.node_count());
  for (int i = 0; i < even.size(); ++i) even[i] = 1 + std::sin(12.9898 * (i + 1) * (i + 1));
  const Estimate spread = Lanczos(A, even);
  const Estimate local = Lanczos(A, even.cwiseProduct(A.diagonal().cwiseAbs2()));
  const Estimate& larger = local.eigenvalue > spread.eigenvalue ? local : spread;
  return larger.eigenvalue + larger.residual;
}

// A bound of the largest eigenvalue, without a search: of any positive x, the largest
// (|A| x)_i / x_i (Collatz; Gershgorin's discs are those of x = 1).
double EigenvalueBound(const SpringMassSystem& system, const Eigen::VectorXd& weight) {
  constexpr int kVectors = 4;
  const ScaledLaplacian A(system, weight);
  Eigen::VectorXd x = system.mass.head(system.node_count()).cwiseSqrt();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kVectors; ++i) {
    const Eigen::VectorXd next = A.AbsoluteTimes(x);
    const double most = next.cwiseQuotient(x).maxCoeff();
    least = std::min(least, most);
    x = next + 1e-3 * most * x;  // stays positive where no spring is
  }
  return least;
}

// Whether all dashpots are as strong as stiffnesses times one time.
bool HasOneLossTime(const SpringMassSystem& system) {
  const double stiffness = system.stiffness.sum();
  if (!(stiffness > 0)) return false;
  const double loss_time = system.dashpot.sum() / stiffness;
  return ((system.dashpot - loss_time * system.stiffness).array().abs() <=
          1e-9 * loss_time * system.stiffness.array())
      .all();
}

// The bound from what `largest` takes the largest eigenvalue of weights for.
StabilityBound BoundFrom(const SpringMassSystem& system,
                         double (*largest)(const SpringMassSystem&, const Eigen::VectorXd&)) {
  const SpringMassSystem bound = system.effects.empty() ? system : BoundingSystem(system);
  StabilityBound result{};
  const double omega_squared = largest(bound, bound.stiffness);
  result.omega_max = std::sqrt(omega_squared);
  result.gamma_max = HasOneLossTime(bound)
                         ? omega_squared * bound.dashpot.sum() / bound.stiffness.sum()
                         : largest(bound, bound.dashpot);
  if (system.dashpot_stages > 1 && bound.spring_count() != system.spring_count()) {
    Eigen::VectorXd other = bound.dashpot;
    other.head(system.spring_count()).setZero();
    result.other_gamma_max = largest(bound, other);
  }
  result.timestep = result.TimestepOf(system.dashpot_stages);
  return result;
}

}  // namespace

double StabilityBound::TimestepOf(int stages) const {
  // h^2 omega^2 + 2 h gamma = limit, in a form that does not cancel
  const auto largest = [&](double gamma, double limit) {
    const double root = gamma + std::sqrt(gamma * gamma + limit * omega_max * omega_max);
    return root > 0 ? limit / root : std::numeric_limits<double>::infinity();
  };
  if (stages == 1) return largest(gamma_max, 4);
  const DashpotLimits limits = LimitsOfStages(stages);
  const double elastic = largest(other_gamma_max, limits.stiffness);
  return gamma_max > 0 ? std::min(elastic, limits.damping / gamma_max) : elastic;
}

double StabilityBound::CheapestTimestep(int most_stages) const {
  double most = 0;
  for (int stages = 1; stages <= most_stages; ++stages) {
    most = std::max(most, TimestepOf(stages) / CostOf(stages));
  }
  return most;
}

StabilityBound ComputeStabilityBound(const SpringMassSystem& system) {
  return BoundFrom(system, LargestEigenvalue);
}

StabilityBound RoughStabilityBound(const SpringMassSystem& system) {
  return BoundFrom(system, EigenvalueBound);
}

bool LimitDashpots(double timestep, SpringMassSystem* system) {
  const int stages = system->dashpot_stages;
  if (timestep <= RoughStabilityBound(*system).CheapestTimestep(stages)) return true;
  const StabilityBound bound = ComputeStabilityBound(*system);
  if (timestep <= bound.CheapestTimestep(stages)) return true;
  double most = 0;  // of gamma
  const double root = timestep * bound.omega_max;
  if (root < 2) most = (4 - root * root) / (2 * timestep);
  for (int s = 2; s <= stages; ++s) {
    const DashpotLimits limits = LimitsOfStages(s);
    const double h = timestep * CostOf(s);
    const double elastic = std::pow(h * bound.omega_max, 2) + 2 * h * bound.other_gamma_max;
    if (elastic < limits.stiffness) most = std::max(most, limits.damping / h);
  }
  if (most == 0 || bound.gamma_max == 0) return false;
  system->dashpot *= most / bound.gamma_max;
  return timestep <= ComputeStabilityBound(*system).CheapestTimestep(stages) * (1 + 1e-6);
}

void SoftenStiffNodes(double timestep, SpringMassSystem* system) {
  const int nodes = system->node_count();
  // of each spring at a node, as a part of what the node may have
  const DashpotLimits limits = LimitsOfStages(system->dashpot_stages);
  Eigen::MatrixX2d load = Eigen::MatrixX2d::Zero(nodes, 2);
  for (int e = 0; e < system->spring_count(); ++e) {
    const double stiffness = 2 * timestep * timestep * system->stiffness[e] / limits.stiffness;
    const double dashpot = 2 * timestep * system->dashpot[e] / limits.damping;
    for (int end : system->springs[e]) {
      if (end < nodes) load.row(end) += Eigen::RowVector2d(stiffness, dashpot) / system->mass[end];
    }
  }
  Eigen::VectorXd together = load.rowwise().sum();
  if (system->dashpot_stages > 1) together = load.rowwise().maxCoeff();
  const Eigen::VectorXd factor = 1 / together.array().max(1.0);
  for (int e = 0; e < system->spring_count(); ++e) {
    double least = 1;
    for (int end : system->springs[e]) {
      if (end < nodes) least = std::min(least, factor[end]);
    }
    system->stiffness[e] *= least;
    system->dashpot[e] *= least;
  }
}

int StableSubsteps(double timestep, double frame_time, double safety) {
  const double substeps = std::ceil(frame_time / (safety * timestep) - 1e-9);
  return static_cast<int>(std::clamp(substeps, 1.0, 1e6));
}

double CostOf(int dashpot_stages) {
  constexpr double kStage = 0.9;  // measured forwards: 0.6 to 1.1
  return 1 + kStage * (dashpot_stages - 1);
}

FrameCut CheapestCut(const StabilityBound& bound, double frame_time, double safety,
                     int most_stages) {
  FrameCut best{};
  double least = std::numeric_limits<double>::infinity();
  for (int stages = 1; stages <= most_stages; ++stages) {
    const int substeps = StableSubsteps(bound.TimestepOf(stages), frame_time, safety);
    const double cost = substeps * CostOf(stages);
    if (cost >= least) continue;
    least = cost;
    best = {substeps, stages};
  }
  return best;
}

int FewestStages(const StabilityBound& bound, double timestep, int most_stages) {
  for (int stages = 1; stages < most_stages; ++stages) {
    if (timestep <= bound.TimestepOf(stages)) return stages;
  }
  return most_stages;
}

FrameCut CutFrames(double frame_time, int substeps, const SpringMassSystem& system) {
  const int most_stages = system.dashpot_stages;
  if (substeps > 0 && most_stages == 1) return {substeps, 1};
  const StabilityBound bound = ComputeStabilityBound(system);
  if (substeps == 0) return CheapestCut(bound, frame_time, kStepSafety, most_stages);
  return {substeps, FewestStages(bound, frame_time / substeps / kStepSafety, most_stages)};
}

}  // namespace physpring
