// SPDX-License-Identifier: Apache-2.0
#include "twin/stability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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
  if (!system.effects.empty()) return BoundFrom(BoundingSystem(system), largest);
  const double omega_squared = largest(system, system.stiffness);
  const double gamma = HasOneLossTime(system)
                           ? omega_squared * system.dashpot.sum() / system.stiffness.sum()
                           : largest(system, system.dashpot);
  // h^2 omega^2 + 2 h gamma = 4, in a form that does not cancel
  const double root = gamma + std::sqrt(gamma * gamma + 4 * omega_squared);
  return {std::sqrt(omega_squared), gamma,
          root > 0 ? 4 / root : std::numeric_limits<double>::infinity()};
}

}  // namespace

StabilityBound ComputeStabilityBound(const SpringMassSystem& system) {
  return BoundFrom(system, LargestEigenvalue);
}

StabilityBound RoughStabilityBound(const SpringMassSystem& system) {
  return BoundFrom(system, EigenvalueBound);
}

bool LimitDashpots(double timestep, SpringMassSystem* system) {
  if (timestep <= RoughStabilityBound(*system).timestep) return true;
  const StabilityBound bound = ComputeStabilityBound(*system);
  if (timestep <= bound.timestep) return true;
  const double root = timestep * bound.omega_max;
  if (root >= 2 || bound.gamma_max == 0) return false;
  system->dashpot *= (4 - root * root) / (2 * timestep) / bound.gamma_max;
  return timestep <= ComputeStabilityBound(*system).timestep * (1 + 1e-6);
}

void SoftenStiffNodes(double timestep, SpringMassSystem* system) {
  const int nodes = system->node_count();
  Eigen::VectorXd load = Eigen::VectorXd::Zero(nodes);
  for (int e = 0; e < system->spring_count(); ++e) {
    const double spring =
        timestep * timestep * system->stiffness[e] + 2 * timestep * system->dashpot[e];
    for (int end : system->springs[e]) {
      if (end < nodes) load[end] += spring / system->mass[end];
    }
  }
  const Eigen::VectorXd factor = 2 / load.array().max(2.0);
  for (int e = 0; e < system->spring_count(); ++e) {
    double least = 1;
    for (int end : system->springs[e]) {
      if (end < nodes) least = std::min(least, factor[end]);
    }
    system->stiffness[e] *= least;
    system->dashpot[e] *= least;
  }
}

int StableSubsteps(const StabilityBound& bound, double frame_time, double safety) {
  const double substeps = std::ceil(frame_time / (safety * bound.timestep) - 1e-9);
  return static_cast<int>(std::clamp(substeps, 1.0, 1e6));
}

}  // namespace physpring
