// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/gramian.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "trainer/reduction/drawn_reduction.h"

namespace physpring {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kRank = 120;
constexpr double kWeakSpring = 1e-6;  // of the mean diagonal of L

// The Laplacian of the free nodes with weights (springs), grounded at the controllers.
Sparse Laplacian(const SpringMassSystem& system, const Eigen::VectorXd& weight) {
  const int nodes = system.node_count();
  std::vector<Eigen::Triplet<double>> entries;
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    if (a < nodes) entries.emplace_back(a, a, weight[e]);
    if (b < nodes) entries.emplace_back(b, b, weight[e]);
    if (std::max(a, b) >= nodes) continue;
    entries.emplace_back(a, b, -weight[e]);
    entries.emplace_back(b, a, -weight[e]);
  }
  Sparse laplacian(nodes, nodes);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

// F (nodes x inputs). Without controllers, every node is an input.
Eigen::MatrixXd Inputs(const SpringMassSystem& system) {
  const int nodes = system.node_count();
  if (system.controllers == 0) return Eigen::MatrixXd::Identity(nodes, nodes);
  Eigen::MatrixXd inputs = Eigen::MatrixXd::Zero(nodes, system.controllers);
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    if (std::max(a, b) < nodes) continue;
    inputs(std::min(a, b), std::max(a, b) - nodes) += system.stiffness[e];
  }
  return inputs;
}

// An M-orthonormal basis (nodes x at most `rank`) of the span of A^-1 F, A^-1 M A^-1 F, ...
Eigen::MatrixXd KrylovBasis(const Eigen::SimplicialLDLT<Sparse>& inverse,
                            const Eigen::VectorXd& mass, const Eigen::MatrixXd& inputs, int rank) {
  constexpr double kDependent = 1e-8;  // of its length, what is left of a vector in the span
  Eigen::MatrixXd basis(mass.size(), 0), block = inverse.solve(inputs);
  while (block.cols() > 0 && basis.cols() < rank) {
    const Eigen::Index before = basis.cols();
    for (Eigen::Index k = 0; k < block.cols() && basis.cols() < rank; ++k) {
      Eigen::VectorXd v = block.col(k);
      const double length = std::sqrt(v.dot(mass.cwiseProduct(v)));
      for (int twice = 0; twice < 2; ++twice) {
        v -= basis * (basis.transpose() * mass.cwiseProduct(v));
      }
      const double left = std::sqrt(v.dot(mass.cwiseProduct(v)));
      if (!(left > kDependent * length)) continue;
      basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
      basis.rightCols(1) = v / left;
    }
    const Eigen::MatrixXd added = basis.rightCols(basis.cols() - before);
    block = inverse.solve(mass.asDiagonal() * added);
  }
  return basis;
}

}  // namespace

Eigen::MatrixXd GramianFeatures(const SpringMassSystem& system, int rank) {
  Sparse stiffness = Laplacian(system, system.stiffness);
  const double weak = kWeakSpring * stiffness.diagonal().mean();
  for (int i = 0; i < stiffness.rows(); ++i) stiffness.coeffRef(i, i) += weak;
  const Eigen::SimplicialLDLT<Sparse> inverse(stiffness);
  const Eigen::MatrixXd inputs = Inputs(system);
  const Eigen::MatrixXd basis = KrylovBasis(inverse, system.mass, inputs, rank);

  // modes within the space
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(basis.transpose() * stiffness * basis);
  const Eigen::VectorXd& w2 = eigen.eigenvalues();
  const Eigen::MatrixXd modes = basis * eigen.eigenvectors();
  const Eigen::MatrixXd damping = modes.transpose() * Laplacian(system, system.dashpot) * modes;
  const Eigen::VectorXd d = damping.diagonal().array() + std::max(system.drag, 1e-3);
  const Eigen::MatrixXd force = modes.transpose() * inputs;
  Eigen::MatrixXd gramian = force * force.transpose();
  for (Eigen::Index k = 0; k < w2.size(); ++k) {
    for (Eigen::Index l = 0; l < w2.size(); ++l) {
      const double sum = d[k] + d[l], apart = w2[k] - w2[l];
      gramian(k, l) *= sum / (apart * apart + sum * (d[k] * w2[l] + d[l] * w2[k]));
    }
  }
  // P = modes gramian modes^T = features features^T
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> root(gramian);
  const Eigen::VectorXd scale = root.eigenvalues().cwiseMax(0).cwiseSqrt();
  return modes * root.eigenvectors() * scale.asDiagonal();
}

namespace {

class GramianReduction : public DrawnReduction {
 public:
  std::string name() const override { return "gramian"; }
  std::string help() const override {
    return "alike in their response to the controllers (controllability Gramian)";
  }

 private:
  Assignment Draw(const SpringMassSystem& system, int nodes,
                  std::uint64_t /*seed*/) const override {
    return Agglomerate(SpringGraph(system), GramianFeatures(system, kRank), nodes);
  }
};

}  // namespace

std::unique_ptr<Reduction> MakeGramian() { return std::make_unique<GramianReduction>(); }

}  // namespace physpring
