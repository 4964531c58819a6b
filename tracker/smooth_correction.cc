// SPDX-License-Identifier: Apache-2.0
#include "tracker/smooth_correction.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

namespace physpring {
namespace {

constexpr int kModes = 96;

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
  const Modes all = LowestModes(StiffnessLaplacian(system), std::min(kModes, system.node_count()));
  const Eigen::Index kept = std::min<Eigen::Index>(kModes, all.values.size());
  modes_ = {all.values.head(kept).cwiseMax(0), all.vectors.leftCols(kept)};
}

Points SmoothCorrection::Solve(const Points& offset, const Eigen::VectorXd& precision,
                               double model_error) const {
  constexpr double kLeastPrecision = 1e-9;  // of the largest: a part that nothing holds stays
  const double largest = precision.size() > 0 ? precision.maxCoeff() : 0;
  if (!(largest > 0)) return Points::Zero(3, offset.cols());
  const Eigen::MatrixXd weighted = precision.cwiseSqrt().asDiagonal() * modes_.vectors;
  Eigen::MatrixXd normal = (modes_.values / model_error).cwiseAbs2().asDiagonal();
  normal.diagonal().array() += kLeastPrecision * largest;
  normal.selfadjointView<Eigen::Lower>().rankUpdate(weighted.transpose());
  const Eigen::MatrixXd right =
      modes_.vectors.transpose() * (precision.asDiagonal() * offset.transpose());
  const Eigen::MatrixXd q = normal.selfadjointView<Eigen::Lower>().llt().solve(right);
  return (modes_.vectors * q).transpose();
}

}  // namespace physpring
