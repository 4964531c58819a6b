// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/spring_modes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <vector>

#include "twin/lowest_modes.h"

namespace physpring {
namespace {

constexpr double kZero = 1e-9;  // eigenvalues up to so many mean diagonal entries are 0

Eigen::SparseMatrix<double> Laplacian(const SpringMassSystem& system) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    const double weight = 1 / (system.rest_length[e] * system.rest_length[e]);
    entries.emplace_back(a, a, weight);
    entries.emplace_back(b, b, weight);
    entries.emplace_back(a, b, -weight);
    entries.emplace_back(b, a, -weight);
  }
  Eigen::SparseMatrix<double> laplacian(system.position.cols(), system.position.cols());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

void MakeFirstPositive(Eigen::Ref<Eigen::VectorXd> field) {
  const auto first =
      std::find_if(field.begin(), field.end(), [](double value) { return std::abs(value) > 0.1; });
  if (first != field.end() && *first < 0) field *= -1;
}

}  // namespace

FieldModes SpringModes(const SpringMassSystem& system, int count) {
  const auto points = static_cast<int>(system.position.cols());
  const Eigen::SparseMatrix<double> laplacian = Laplacian(system);
  const double zero = kZero * laplacian.diagonal().mean();
  Modes modes;
  // each object has an eigenvalue 0 of its own
  int zeros = 1;
  for (int asked = std::min(count + 1, points);; asked = std::min(2 * asked, points)) {
    modes = LowestModes(laplacian, asked);
    zeros = static_cast<int>((modes.values.array() <= zero).count());
    if (asked == points || modes.values.size() >= zeros + count) break;
  }
  const int kept = std::min(count, static_cast<int>(modes.values.size()) - zeros);
  Eigen::MatrixXd fields(system.spring_count(), std::max(0, kept));
  Eigen::VectorXd roughness(fields.cols());
  for (int m = 0; m < fields.cols(); ++m) {
    roughness[m] = modes.values[zeros + m] / modes.values[zeros];
    const auto mode = modes.vectors.col(zeros + m);
    for (int e = 0; e < system.spring_count(); ++e) {
      fields(e, m) = 0.5 * (mode[system.springs[e][0]] + mode[system.springs[e][1]]);
    }
    fields.col(m) /= std::sqrt(fields.col(m).squaredNorm() / system.spring_count());
    MakeFirstPositive(fields.col(m));
  }
  return {fields, roughness};
}

Eigen::MatrixXd EvenSlopes(const SpringMassSystem& system) {
  constexpr double kLeastSpread = 0.2;
  Points middle(3, system.spring_count());
  for (int e = 0; e < system.spring_count(); ++e) {
    const auto [a, b] = system.springs[e];
    middle.col(e) = 0.5 * (system.position.col(a) + system.position.col(b));
  }
  middle.colwise() -= middle.rowwise().mean().eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(middle * middle.transpose());
  const Eigen::Vector3d spread = axes.eigenvalues().cwiseMax(0).cwiseSqrt();  // rising
  int count = 0;
  while (count < 3 && spread[2 - count] > kLeastSpread * spread[2]) ++count;
  Eigen::MatrixXd slopes(system.spring_count(), count);
  for (int i = 0; i < count; ++i) {
    slopes.col(i) = std::sqrt(system.spring_count()) / spread[2 - i] *
                    (middle.transpose() * axes.eigenvectors().col(2 - i));
    MakeFirstPositive(slopes.col(i));
  }
  return slopes;
}

}  // namespace physpring
