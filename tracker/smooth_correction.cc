// SPDX-License-Identifier: Apache-2.0
#include "tracker/smooth_correction.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

namespace physpring {
namespace {

constexpr Eigen::Index kModes = 96, kCoarseModes = 24;

// Of the free nodes; its mean diagonal is 1.
Eigen::SparseMatrix<double> StiffnessLaplacian(const SpringMassSystem& system) {
  const int nodes = system.node_count();
  std::vector<Eigen::Triplet<double>> entries;
  double trace = 0;
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[static_cast<std::size_t>(e)];
    const double k = system.stiffness[e];
    for (int end : {a, b}) {
      if (end >= nodes) continue;
      entries.emplace_back(end, end, k);
      trace += k;
    }
    if (a >= nodes || b >= nodes) continue;
    entries.emplace_back(a, b, -k);
    entries.emplace_back(b, a, -k);
  }
  Eigen::SparseMatrix<double> laplacian(nodes, nodes);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  if (trace > 0) laplacian *= nodes / trace;
  return laplacian;
}

}  // namespace

SmoothCorrection::SmoothCorrection(const SpringMassSystem& system) {
  const Modes all = LowestModes(StiffnessLaplacian(system),
                                std::min(static_cast<int>(kModes), system.node_count()));
  const Eigen::Index kept = std::min<Eigen::Index>(kModes, all.values.size());
  modes_ = {all.values.head(kept).cwiseMax(0), all.vectors.leftCols(kept)};
}

Points SmoothCorrection::Solve(const Points& offset, const Eigen::VectorXd& precision,
                               double model_error, Detail detail) const {
  constexpr double kLeastPrecision = 1e-9;  // of the largest: a part that nothing holds stays
  const double largest = precision.size() > 0 ? precision.maxCoeff() : 0;
  if (!(largest > 0)) return Points::Zero(3, offset.cols());
  std::vector<Eigen::Index> measured;
  for (Eigen::Index i = 0; i < precision.size(); ++i) {
    if (precision[i] > 0) measured.push_back(i);
  }
  const Eigen::Index modes =
      std::min(modes_.values.size(), detail == Detail::kCoarse ? kCoarseModes : kModes);
  const auto shapes = modes_.vectors.leftCols(modes);
  const Eigen::VectorXd root = precision(measured).cwiseSqrt();
  const Eigen::MatrixXd weighted = root.asDiagonal() * shapes(measured, Eigen::all);
  Eigen::MatrixXd normal = (modes_.values.head(modes) / model_error).cwiseAbs2().asDiagonal();
  normal.diagonal().array() += kLeastPrecision * largest;
  normal.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
  const Points pull = offset(Eigen::all, measured) * root.asDiagonal();
  const Eigen::MatrixXd right = weighted.transpose() * pull.transpose();
  const Eigen::MatrixXd q = normal.selfadjointView<Eigen::Lower>().llt().solve(right);
  return (shapes * q).transpose();
}

}  // namespace physpring
