// SPDX-License-Identifier: Apache-2.0
#ifndef PHYSPRING_TWIN_LOWEST_MODES_H_
#define PHYSPRING_TWIN_LOWEST_MODES_H_

#include <Eigen/Core>
#include <Eigen/SparseCore>

namespace physpring {

// Eigenvalues, rising, and their eigenvectors of length 1, the columns.
struct Modes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

// The `count` lowest modes of a Laplacian (symmetric, no eigenvalue below 0), or more: of few
// points all of them.
Modes LowestModes(const Eigen::SparseMatrix<double>& laplacian, int count);

}  // namespace physpring

#endif  // PHYSPRING_TWIN_LOWEST_MODES_H_
